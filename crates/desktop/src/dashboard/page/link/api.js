// Requests to the program: the token, JSON both ways, and one kind of error.

const TOKEN = "tactpad-token";
const NO_ANSWER = "tactpad does not answer: start it again.";

/** An answer that is no success; `message` is one sentence for people. */
export class RequestError extends Error {
  constructor(status, body) {
    super(body?.error ?? `The program answered ${status}.`);
    this.status = status;
    this.body = body;
  }
}

/** Takes the token from the address, where it must not stay, and keeps it for this tab. */
export function takeToken() {
  const address = new URL(location.href);
  const token = address.searchParams.get("token");
  if (token !== null) {
    sessionStorage.setItem(TOKEN, token);
    address.searchParams.delete("token");
    history.replaceState(null, "", address);
  }
  return sessionStorage.getItem(TOKEN);
}

const token = () => sessionStorage.getItem(TOKEN) ?? "";

/** Keeps the token of the program that was found again. */
export function setToken(token) {
  sessionStorage.setItem(TOKEN, token);
}

/** Whether whoever answers is known to be the program: nobody else is asked for anything. */
let isConnected = true;

/** Says whether requests may be sent. */
export function setConnected(connected) {
  isConnected = connected;
}

/** A path that a new tab can open. */
export const withToken = (path) => `${path}?token=${encodeURIComponent(token())}`;

/** The address of the live socket. */
export function liveAddress() {
  return `ws://${location.host}/api/live?token=${encodeURIComponent(token())}`;
}

async function bodyOf(response) {
  const text = await response.text();
  if (text === "") return {};
  try {
    return JSON.parse(text);
  } catch {
    return { ok: false, error: text };
  }
}

/**
 * Sends one request.
 * @param {string} method
 * @param {string} path
 * @param {object | string | null} body an object goes as JSON, a string as plain text
 * @param {Record<string, string>} headers
 */
export async function request(method, path, body = null, headers = {}) {
  if (!isConnected) throw new RequestError(0, { error: NO_ANSWER });
  const plain = typeof body === "string";
  const type = plain ? "text/plain; charset=utf-8" : "application/json";
  let response;
  try {
    response = await fetch(path, {
      method,
      cache: "no-store",
      headers: { Authorization: `Bearer ${token()}`, ...(body === null ? {} : { "Content-Type": type }), ...headers },
      body: body === null || plain ? body : JSON.stringify(body),
    });
  } catch {
    throw new RequestError(0, { error: NO_ANSWER });
  }
  const answer = await bodyOf(response);
  if (!response.ok) throw new RequestError(response.status, answer);
  return answer;
}

export const get = (path) => request("GET", path);
export const post = (path, body = {}) => request("POST", path, body);
