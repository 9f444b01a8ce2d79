// Runs the page's tests: all of them on the mock server, or the core ones on REND_URL.
// Usage: node run.mjs [FOLDER_FOR_SCREENSHOTS], with REND_URL=http://127.0.0.1:8080 for a running program.
import { after, before } from "node:test";
import { browser, real_url } from "./browser.mjs";
import { core_tests } from "./core_tests.mjs";
import { start_mock } from "./mock_server.mjs";

let mock;
if (real_url) {
  core_tests(() => real_url, "real-");
} else {
  before(async () => {
    mock = await start_mock();
  });
  core_tests(() => mock.url, "core-");
  await import("./time_tests.mjs");
  await import("./control_tests.mjs");
  await import("./quantity_tests.mjs");
  await import("./tool_tests.mjs");
  await import("./link_tests.mjs");
  await import("./state_tests.mjs");
}

after(async () => {
  await mock?.close();
  await browser.close();
});
