// Links: what is seen goes into the address and comes back from it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { open_page, until, settled } from "./browser.mjs";
import { start_mock } from "./mock_server.mjs";

test("a copied link holds scene, values, view and frame, and opens them again", async () => {
  const mock = await start_mock(),
    { run } = mock;
  Object.assign(run, { scene: "twist", frame: 50 });
  const first = await open_page(mock.url, { calm: true });
  await until("parameters", () => first.page.locator(".hero").count());
  await first.page.locator(".hero .number input").fill("50");
  await first.page.locator(".hero .number input").press("Enter");
  await first.page.locator("#color").selectOption("stress");
  await first.page.locator("#scrub").fill("31");
  await first.page.locator("#picture").focus();
  const before = run.frame_requests.at(-1)?.eye;
  await first.page.keyboard.press("ArrowLeft");
  await until("the turned view", () => {
    const last = run.frame_requests.at(-1);
    return last.color === "stress" && last.eye !== before;
  });
  await settled(first.page, 800);
  const { eye } = run.frame_requests.at(-1);
  await first.page.locator("#link-button").click();
  await until("an address", async () => first.page.url().includes("#scene=twist"));
  const link = first.page.url();
  await first.close();

  Object.assign(run, { scene: "tear", frame: 0, frame_requests: [] });
  run.parameters[0].value = 2e4;
  const second = await open_page(link, { calm: true });
  await until("the scene", () => run.scene === "twist");
  await until("its threshold", () => run.parameters[0].value === 5e4);
  await until("its view and colours", () => {
    const last = run.frame_requests.at(-1);
    return last && last.eye === eye && last.color === "stress";
  });
  run.set({ frame: 40 });
  await until(
    "its frame",
    async () => (await second.page.locator("#read-frame").textContent()) === "31",
  );
  assert.deepEqual(second.troubles, []);
  await second.close();
  await mock.close();
});

test("a broken link opens what it can and says what is missing", async () => {
  const mock = await start_mock();
  const broken = `${mock.url}/#scene=nowhere&eye=1,2&frame=x&color=none-such&set:tau_c=high`;
  const { page, troubles, close } = await open_page(broken, { calm: true });
  await until("a word", async () => /no scene nowhere/.test(await page.locator("#toast").innerText()));
  assert.equal(mock.run.scene, "tear");
  await close();
  const other = await open_page(`${mock.url}/#scene=tear&color=none-such&mode=9&set:tau_c=1e9`, {
    calm: true,
  });
  await until("a refusal", async () =>
    /not allowed/.test(await other.page.locator("#toast").innerText()),
  );
  assert.equal(await other.page.locator("#color").inputValue(), "damage");
  assert.deepEqual(troubles, []);
  await other.close();
  await mock.close();
});
