// Runs the page's tests: all of them on the mock server, or the core ones on REND_URL.
// Usage: node run.mjs [FOLDER_FOR_SCREENSHOTS], with REND_URL=http://127.0.0.1:8080 for a running program.
import { after, before, beforeEach, test } from "node:test";
import { real_url } from "./browser.mjs";
import { core_tests } from "./core_tests.mjs";
import { start_mock } from "./mock_server.mjs";
import { Watchdog } from "./watchdog.mjs";

const SUITES = ["time", "control", "quantity", "tool", "link", "state"];

let mock;
const watchdog = new Watchdog();
before(async () => {
  if (!real_url) mock = await start_mock();
});
beforeEach(({ name }) => watchdog.hear(name));
after(() => watchdog.hear("the end of all tests"));

if (real_url) {
  core_tests(() => real_url, "real-");
} else {
  core_tests(() => mock.url, "core-");
  for (const suite of SUITES) {
    try {
      await import(`./${suite}_tests.mjs`);
    } catch (error) {
      // Node's runner makes a mere warning of an error outside of tests.
      test(`${suite}_tests.mjs loads`, () => {
        throw error;
      });
    }
  }
}
