// A short tone for each cue, for those who asked for it under "Display".

import { sounds } from "./settings.js";

const PITCH_HZ = 660;
const LENGTH_S = 0.18;
const LOUDNESS = 0.2;
/** @type {AudioContext | null} */
let audio = null;

/** Sounds once. */
export function cueTone() {
  if (!sounds()) return;
  audio ??= new AudioContext();
  const [tone, loudness, now] = [audio.createOscillator(), audio.createGain(), audio.currentTime];
  tone.frequency.value = PITCH_HZ;
  loudness.gain.setValueAtTime(LOUDNESS, now);
  // Faded out, so that its end does not click.
  loudness.gain.exponentialRampToValueAtTime(0.001, now + LENGTH_S);
  tone.connect(loudness).connect(audio.destination);
  tone.start(now);
  tone.stop(now + LENGTH_S);
}
