// Ends the tests with a clear message when nothing happens any more, instead of waiting for ever.
import { patience } from "./browser.mjs";

/// No test takes longer: the waits inside of one are 2 minutes at most.
const MOST_SECONDS = 300 * patience;

export class Watchdog {
  #timer;

  /// `name` begins now and has MOST_SECONDS.
  hear(name) {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      console.error(`page tests: "${name}" is not over after ${MOST_SECONDS} s; the tests are ended`);
      process.exit(1);
    }, MOST_SECONDS * 1000).unref();
  }
}
