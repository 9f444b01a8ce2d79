// Every state of the page at every width, light and dark: looked at by axe, nothing outside the window.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { caught_up, open_page, picture_of, settled, until } from "./browser.mjs";
import { start_mock } from "./mock_server.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];
const WINDOWS = [
  [360, 740],
  [768, 1024],
  [1024, 768],
  [1440, 900],
];
const REASON = {
  status: "time_step",
  frame: 71,
  text: "A particle moved 1.8 cells in one step, more than the 0.6 that is stable.",
};

/// [name, enter, leave]: each starts from frame 74, paused.
const STATES = [
  ["paused", async () => {}],
  [
    "playing",
    async (page, run) => {
      run.set({ status: "playing" });
      await page.locator("#mode.live").waitFor({ state: "attached" });
    },
    async (page, run) => run.set({ status: "paused" }),
  ],
  [
    "stopped",
    async (page, run) => {
      run.set({ status: "stopped", frame: 70, reason: REASON });
      await page.locator("#stopped").waitFor();
    },
    async (page, run) => run.set({ status: "paused", frame: 74, reason: null }),
  ],
  [
    "preparing",
    async (page, run) => {
      run.set({ status: "preparing", progress: { stage: "mesh", share: 0.4 } });
      await page.locator("#preparing").waitFor();
    },
    async (page, run) => run.set({ status: "paused", progress: null }),
  ],
  [
    "recorded",
    async (page) => {
      await page.locator("#scrub").fill("40");
      await page.locator("#newest-button").waitFor({ state: "attached" });
    },
    async (page) => page.keyboard.press("End"),
  ],
  [
    "help",
    async (page) => {
      await page.locator("#help-button").click();
      await page.locator("#help").waitFor();
    },
    async (page) => page.keyboard.press("Escape"),
  ],
  [
    "export",
    async (page) => {
      await page.locator("#export-button").click();
      await page.locator("#export").waitFor();
    },
    async (page) => page.keyboard.press("Escape"),
  ],
  [
    "export job",
    async (page) => {
      await page.locator("#export-button").click();
      await page.getByLabel("All", { exact: true }).check();
      await page.evaluate(() => {
        document.querySelector("#export-job").hidden = false;
        document.querySelector("#export-job-text").textContent = "Frame 31 of 96, 12 s left";
      });
    },
    async (page) => page.keyboard.press("Escape"),
  ],
  [
    "drop",
    async (page) =>
      page.evaluate(() => {
        document.querySelector("#veil").hidden = false;
      }),
    async (page) =>
      page.evaluate(() => {
        document.querySelector("#veil").hidden = true;
      }),
  ],
  ["scenes", (page) => press_tab(page, "scenes"), (page) => press_tab(page, "material")],
  ["view", (page) => press_tab(page, "view"), (page) => press_tab(page, "material")],
  ["plots", (page) => press_tab(page, "plots"), (page) => press_tab(page, "material")],
  [
    "warned",
    async (page, run) => {
      run.set({ energy_warning: "The run has gained 3 J that nothing put in; lower cfl." });
      await page.locator("#energy-warning").waitFor();
    },
    async (page, run) => {
      run.set({ energy_warning: null });
      await page.locator("#energy-warning").waitFor({ state: "hidden" });
    },
  ],
  [
    "pulling",
    async (page, run) => {
      run.set({
        pull: { at: [0, 0.27, 0], target: [0.2, 0.5, 0], radius: 0.06, force: [1200, 0, 0] },
      });
      await page.locator("#grip-force").waitFor();
      await page.locator(".tool[data-tool=pull]").click();
    },
    async (page, run) => {
      await page.locator(".tool[data-tool=pull]").click();
      run.set({ pull: null });
    },
  ],
  [
    "probing",
    async (page) => {
      await page.locator(".tool[data-tool=probe]").click();
      await page.locator("#picture").hover();
      await page.locator("#probe").waitFor();
    },
    async (page) => page.locator(".tool[data-tool=pull]").click(),
  ],
  [
    "lost",
    async (page, run) => {
      run.down = true;
      run.changed();
      await page.locator("#lost").waitFor();
    },
    async (page, run) => {
      run.down = false;
      await page.locator("#lost-retry").evaluate((button) => button.click());
      await page.locator("#lost").waitFor({ state: "hidden" });
    },
  ],
];

async function press_tab(page, name) {
  const tab = page.locator(`.tabs [data-tab=${name}]`);
  if (await tab.isVisible()) await tab.click();
}

/// Dark and light differ in colours only, so dark is looked at for contrast alone.
async function violations_of(page, scheme) {
  const only =
    scheme === "dark"
      ? { type: "rule", values: ["color-contrast"] }
      : { type: "tag", values: TAGS };
  return page.evaluate(async (runOnly) => {
    const { violations } = await axe.run(document, { runOnly, resultTypes: ["violations"] });
    return violations.map(
      ({ id, nodes }) =>
        `${id}: ${nodes.map(({ target, failureSummary }) => `${target} ${failureSummary.split("\n")[1] ?? ""}`).join(" | ")}`,
    );
  }, only);
}

/// Visible controls that stick out of the window on the left or right.
const outside = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll("button, input, select, b, h1, h2, p")]
      .filter((node) => node.checkVisibility?.({ checkVisibilityCSS: true, checkOpacity: true }))
      .map((node) => [node, node.getBoundingClientRect()])
      .filter(([, box]) => box.width > 1 && (box.left < -1 || box.right > innerWidth + 1))
      .map(
        ([node, box]) =>
          `${node.id || node.className || node.textContent.slice(0, 20)} ${box.left}..${box.right}`,
      ),
  );

for (const [width, height] of WINDOWS) {
  for (const scheme of ["light", "dark"]) {
    test(`${width} x ${height}, ${scheme}: every state is accessible and inside the window`, async () => {
      const mock = await start_mock();
      Object.assign(mock.run, { frame: 74 });
      const { page, troubles, close } = await open_page(mock.url, {
        width,
        height,
        scheme,
        calm: true,
      });
      try {
        await page.evaluate(AXE);
        await until(
          "ready",
          async () =>
            (await page.locator(".scene img").count()) === 5 &&
            (await page.locator(".hero").count()),
        );
        const found = [];
        for (const [name, enter, leave] of STATES) {
          const tabbed = ["scenes", "view", "plots"].includes(name);
          if (tabbed && width >= 900) continue;
          if (name === "lost") assert.deepEqual(troubles, []);
          await enter(page, mock.run);
          await settled(page, 150);
          for (const violation of await violations_of(page, scheme))
            found.push(`${name}: ${violation}`);
          for (const node of await outside(page))
            found.push(`${name}: outside the window: ${node}`);
          await picture_of(page, `${width}-${scheme}-${name}`);
          await leave?.(page, mock.run);
        }
        assert.deepEqual(found, []);
        const foreign = troubles.filter((line) => !line.includes("Failed to load resource"));
        assert.deepEqual(foreign, []);
      } finally {
        await close();
        await mock.close();
      }
    });
  }
}

test("the picture is at least half of a desktop window and 40 % of a phone's", async () => {
  const mock = await start_mock();
  for (const [[width, height], least] of [
    [[1440, 900], 0.5],
    [[768, 1024], 0.48],
    [[360, 740], 0.38],
  ]) {
    const { page, close } = await open_page(mock.url, { width, height, calm: true });
    await until("parameters", () => page.locator(".hero").count());
    const box = await page.locator(".stage").boundingBox();
    assert.ok(
      (box.width * box.height) / (width * height) >= least,
      `${width}: ${box.width} x ${box.height}`,
    );
    await close();
  }
  await mock.close();
});

test("a stopped run names its frame and offers ways out; losing the server keeps the picture", async () => {
  const mock = await start_mock(),
    { run } = mock;
  run.frame = 74;
  const { page, close } = await open_page(mock.url, { calm: true });
  await until("parameters", () => page.locator(".hero").count());
  run.set({ status: "stopped", frame: 70, reason: REASON });
  await page.locator("#stopped").waitFor();
  assert.match(
    await page.locator("#stopped").textContent(),
    /stopped at frame 71.*1\.8 cells.*Frame 70 is the last good one/s,
  );
  await page.getByRole("button", { name: "Halve the time step, start again" }).click();
  await until(
    "a reset with half the step",
    () => run.frame === 0 && run.parameters.find(({ id }) => id === "cfl").value === 0.3,
  );
  await page.locator("#stopped").waitFor({ state: "hidden" });
  run.down = true;
  run.changed();
  await page.locator("#lost").waitFor();
  assert.match(
    await page.locator("#lost").textContent(),
    /Connection lost\. This is frame 0\.\s*Trying again in \d s/,
  );
  assert.equal(
    await page.locator("#picture").evaluate((canvas) => canvas.classList.contains("empty")),
    false,
  );
  run.down = false;
  run.set({ frame: 9 });
  await page.locator("#lost").waitFor({ state: "hidden" });
  await until(
    "the newest frame",
    async () => (await page.locator("#read-frame").textContent()) === "9",
  );
  await close();
  await mock.close();
});

test("the energy sheet adds up, in joules, and leaves out what the scene never has", async () => {
  const mock = await start_mock({ frames: 100 });
  Object.assign(mock.run, { frame: 50 });
  const { page, close } = await open_page(mock.url, { calm: true });
  await until("a sheet", async () => (await page.locator("#energy-sheet div").count()) > 0);
  const rows = await page.locator("#energy-sheet div").allInnerTexts();
  const words = rows.map((row) => row.replace(/\s+/g, " "));
  assert.deepEqual(
    words.map((row) => row.replace(/ [-−\d.,e]+ J$/, "")),
    ["+ external work", "kinetic", "elastic", "dissipated", "transfer loss"],
  );
  assert.ok(
    words.every((row) => / [-−\d.,e]+ J$/.test(row)),
    words.join("; "),
  );
  assert.match(words[0], /35 J/);
  assert.match(words[4], /1\.5 J/);
  assert.match(await page.locator("#energy-figures").innerText(), /3\.5 % lost in transfers/);
  assert.match(await page.locator("#momentum-figures").innerText(), /y [-−]0\.1/);
  await page.locator("#scrub").fill("100");
  await close();
  await mock.close();
});

test("energy out of bounds warns until it is dismissed, and again after it was in bounds", async () => {
  const mock = await start_mock(),
    { page, close } = await open_page(mock.url, { calm: true }),
    banner = page.locator("#energy-warning");
  await until("parameters", () => page.locator(".hero").count());
  assert.equal(await banner.isVisible(), false);
  mock.run.set({ energy_warning: "The run has gained 3 J that nothing put in; lower cfl." });
  await banner.waitFor();
  assert.match(await banner.innerText(), /gained 3 J/);
  mock.run.set({ energy_warning: "The run has gained 4 J that nothing put in; lower cfl." });
  await until("new figures", async () => /4 J/.test(await banner.innerText()));
  await banner.getByRole("button", { name: "Dismiss the warning" }).click();
  mock.run.set({ energy_warning: "The run has gained 5 J that nothing put in; lower cfl." });
  await caught_up(mock.run);
  assert.equal(await banner.isVisible(), false);
  mock.run.set({ energy_warning: null });
  await caught_up(mock.run);
  mock.run.set({ energy_warning: "Transfers have damped 9 J, 60 % of the energy." });
  await banner.waitFor();
  assert.match(await banner.innerText(), /damped 9 J/);
  await close();
  await mock.close();
});
