// The handshake with the program: it proves itself before it is told anything, and says where the page is now.
//
// The keys are nowhere but in this page's memory: what a browser keeps for an address, whoever answers there later can read.

import { get } from "./api.js";

const WAIT_MS = 2000;
/** Where pages are: an address of this machine. */
const ORIGIN = /^http:\/\/127(?:\.\d{1,3}){3}:\d{1,5}$/;

/** @type {CryptoKey | null} */
let proofKey = null;

/** Bytes as hexadecimal digits. */
export const hex = (bytes) => [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
const bytesOf = (text) => Uint8Array.from(text.match(/../g) ?? [], (pair) => parseInt(pair, 16));

/** Fetches the keys, with the token. @returns {Promise<CryptoKey>} the one for drafts */
export async function fetchKeys() {
  const { proofs, drafts } = await get("/api/keys");
  proofKey = await crypto.subtle.importKey("raw", bytesOf(proofs), { name: "HMAC", hash: "SHA-256" }, false, ["verify"]);
  return crypto.subtle.importKey("raw", bytesOf(drafts), "AES-GCM", false, ["encrypt", "decrypt"]);
}

async function isProven({ proof, origin, token }, nonce) {
  const words = new TextEncoder().encode([location.host, nonce, origin, token].join("\n"));
  return crypto.subtle.verify("HMAC", proofKey, bytesOf(proof), words);
}

async function ask(nonce) {
  const response = await fetch("/handshake", {
    method: "POST", cache: "no-store", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ nonce }), signal: AbortSignal.timeout(WAIT_MS),
  });
  return response.ok ? response.json() : null;
}

/**
 * Makes the handshake; null is nobody, or not this user's program. A page without keys has just come from whoever is there, so it takes the answer.
 * @param {{ isFresh: boolean }} page whether it has no keys yet
 * @returns {Promise<{ origin: string, token: string } | null>}
 */
export async function handshake({ isFresh }) {
  const nonce = hex(crypto.getRandomValues(new Uint8Array(32)));
  try {
    const answer = await ask(nonce);
    if (answer === null || !ORIGIN.test(answer.origin)) return null;
    const known = isFresh ? proofKey === null : proofKey !== null && await isProven(answer, nonce);
    return known ? { origin: answer.origin, token: String(answer.token) } : null;
  } catch {
    return null;
  }
}
