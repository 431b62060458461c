// How old the picture is: the program's clock as seen from here, and the ages of the last frames.

const KEPT_ROUND_TRIPS = 30;
const KEPT_AGES = 200;

/** Microseconds on this page's own clock. */
export const pageUs = () => performance.now() * 1000;

/** Estimates the program's clock from round trips: the fastest one says most. */
export class HostClock {
  #sent = new Map();
  #trips = [];
  #next = 1;
  #offset_us = null;

  /** The next ping. */
  ping() {
    const id = this.#next++;
    this.#sent.set(id, pageUs());
    if (this.#sent.size > KEPT_ROUND_TRIPS) this.#sent.delete(this.#sent.keys().next().value);
    return { kind: "ping", id };
  }

  /** Takes the answer to a ping. */
  pong({ id, host_us }) {
    const sent_us = this.#sent.get(id);
    if (sent_us === undefined) return;
    this.#sent.delete(id);
    const now_us = pageUs();
    this.#trips.push({ delay_us: now_us - sent_us, offset_us: host_us - (now_us + sent_us) / 2 });
    if (this.#trips.length > KEPT_ROUND_TRIPS) this.#trips.shift();
    this.#offset_us = this.#trips.reduce((best, trip) => (trip.delay_us < best.delay_us ? trip : best)).offset_us;
  }

  /** Forgets everything: another connection may be another program. */
  reset() {
    this.#sent.clear();
    this.#trips = [];
    this.#offset_us = null;
  }

  /** Milliseconds since then, or null as long as no ping has come back. */
  ageMs(host_us) {
    return this.#offset_us === null ? null : (pageUs() + this.#offset_us - host_us) / 1000;
  }
}

/** Counts frames and keeps their last ages. */
export class FrameAges {
  #ages = [];
  #times_ms = [];
  count = 0;

  take(age_ms) {
    this.count += 1;
    const now = performance.now();
    this.#times_ms.push(now);
    while (this.#times_ms[0] < now - 1000) this.#times_ms.shift();
    if (age_ms === null) return;
    this.#ages.push(Math.max(age_ms, 0));
    if (this.#ages.length > KEPT_AGES) this.#ages.shift();
  }

  /** Frames of the last second. */
  perSecond() {
    const since = performance.now() - 1000;
    return this.#times_ms.filter((time) => time >= since).length;
  }

  /** The 95th percentile of the last ages in milliseconds, or null. */
  p95() {
    if (this.#ages.length === 0) return null;
    const sorted = [...this.#ages].sort((a, b) => a - b);
    return sorted[Math.ceil(sorted.length * 0.95) - 1];
  }
}
