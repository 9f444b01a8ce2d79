// Pull, probe and orbit on the mock server, whose body fills the middle of the picture.
import assert from "node:assert/strict";
import { test } from "node:test";
import { open_page, settled, until } from "./browser.mjs";
import { start_mock } from "./mock_server.mjs";

async function with_page(body, page_options = {}) {
  const mock = await start_mock();
  const held = await open_page(mock.url, { calm: true, ...page_options });
  await until("a picture", () =>
    held.page.evaluate(() => !document.querySelector("#picture").classList.contains("empty")),
  );
  const box = await held.page.locator("#picture").boundingBox();
  const at = (x, y) => [box.x + x * box.width, box.y + y * box.height];
  try {
    await body(held.page, mock.run, at);
    assert.deepEqual(held.troubles, []);
  } finally {
    await held.close();
    await mock.close();
  }
}
const eyes = (run) => run.frame_requests.map(({ eye }) => eye);
const grip_shown = (page) =>
  page.locator("#grip").evaluate((node) => !node.hasAttribute("hidden"));

test("a press on the body pulls at it until the release; time starts", async () => {
  await with_page(async (page, run, at) => {
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down();
    await until("a grip", () => run.pulls.length > 0);
    const [first] = run.pulls;
    assert.deepEqual(first.at, [0.1, 0.27, 0]);
    assert.deepEqual([first.radius, first.strength], [0.06, 40]);
    assert.equal(run.status, "playing");
    await page.mouse.move(...at(0.6, 0.3), { steps: 8 });
    await until("a target above", () => run.pulls.at(-1).target[1] > 0.4);
    assert.equal(run.pulls.at(-1).at, undefined, "the grip stays with the matter");
    await until("the force", async () => (await page.locator("#grip-force").innerText()) === "5 N");
    const before = new Set(eyes(run)).size;
    await page.mouse.up();
    await until("released", () => run.pulls.at(-1).radius === 0);
    await until("no grip", async () => !(await grip_shown(page)));
    assert.equal(new Set(eyes(run)).size, before, "the view stays");
    assert.equal(run.status, "playing");
  });
});

test("a press beside the body turns the view, with what the pointer did while the server looked", async () => {
  await with_page(async (page, run, at) => {
    const before = eyes(run).at(-1);
    await page.mouse.move(...at(0.1, 0.1));
    await page.mouse.down();
    await page.mouse.move(...at(0.3, 0.15), { steps: 2 });
    await page.mouse.up();
    await until("another view", () => eyes(run).at(-1) !== before);
    assert.equal(run.pulls.length, 0);
    assert.equal(await grip_shown(page), false);
  });
});

test("the orbit tool turns the view on the body too; right drag and a second finger never pull", async () => {
  await with_page(async (page, run, at) => {
    await page.keyboard.press("3");
    const before = eyes(run).at(-1);
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down();
    await page.mouse.move(...at(0.6, 0.5), { steps: 3 });
    await page.mouse.up();
    await until("another view", () => eyes(run).at(-1) !== before);
    await page.keyboard.press("1");
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down({ button: "right" });
    await page.mouse.move(...at(0.55, 0.5), { steps: 3 });
    await page.mouse.up({ button: "right" });
    await settled(page);
    assert.equal(run.pulls.length, 0);
  });
});

test("Escape, a second finger and a closed page let go", async () => {
  await with_page(async (page, run, at) => {
    const grab = async () => {
      const had = run.pulls.length;
      await page.mouse.move(...at(0.5, 0.5));
      await page.mouse.down();
      await until("a grip", () => run.pulls.length > had && run.pulls.at(-1).radius > 0);
    };
    await grab();
    await page.keyboard.press("Escape");
    await until("released by Escape", () => run.pulls.at(-1).radius === 0);
    await page.mouse.up();
    await grab();
    await page.locator("#picture").dispatchEvent("pointercancel", { pointerId: 1 });
    await until("released by a cancelled pointer", () => run.pulls.at(-1).radius === 0);
    await page.mouse.up();
  });
});

test("keys pull too: Enter takes hold in the middle, arrows move the end, Enter or leaving lets go", async () => {
  await with_page(async (page, run) => {
    const picture = page.locator("#picture");
    await picture.focus();
    await page.keyboard.press("Enter");
    await until("a grip", () => run.pulls.length > 0);
    const start = run.pulls[0].at;
    assert.deepEqual(start, [0.1, 0.27, 0]);
    const before = new Set(eyes(run)).size;
    for (let n = 0; n < 5; ++n) await page.keyboard.press("ArrowUp");
    await until("a target above", () => run.pulls.at(-1).target?.[1] > start[1] + 0.02);
    assert.equal(new Set(eyes(run)).size, before, "the view stays");
    await page.keyboard.press("Enter");
    await until("released", () => run.pulls.at(-1).radius === 0);
    await page.keyboard.press("ArrowLeft");
    await until("another view", () => new Set(eyes(run)).size > before);
    await page.keyboard.press("Enter");
    await until("a grip again", () => run.pulls.at(-1).radius > 0);
    await picture.blur();
    await until("released by leaving", () => run.pulls.at(-1).radius === 0);
    await picture.focus();
    const had = run.pulls.length,
      probed = run.probes.length;
    const answer = run.hold_probes();
    await page.keyboard.press("Enter");
    await page.keyboard.press("Enter");
    answer();
    await until("an answer that comes too late", () => run.probes.length > probed);
    await settled(page, 600);
    assert.ok(run.pulls.slice(had).every(({ radius }) => radius === 0), "let go before the server had looked");
    assert.equal(await grip_shown(page), false);
  });
});

test("in the past and after the end pulling says what to do instead", async () => {
  await with_page(async (page, run, at) => {
    const toast_of_press = async (text) => {
      await page.mouse.move(...at(0.5, 0.5));
      await page.mouse.down();
      await until("a way", async () => text.test(await page.locator("#toast").innerText()));
      await page.mouse.up();
    };
    run.set({ frame: 60 });
    await until("frame 60", async () => (await page.locator("#read-frame").textContent()) === "60");
    await page.locator("#scrub").fill("20");
    await toast_of_press(/newest/);
    await page.locator("#toast button").click();
    await until("newest", async () => (await page.locator("#read-frame").textContent()) === "60");
    run.set({ frame: 120, status: "finished" });
    await until("finished", async () => /120/.test(await page.locator("#read-frame").textContent()));
    await toast_of_press(/Reset to pull/);
    assert.equal(run.pulls.length, 0);
    await page.locator("#toast button").click();
    await until("reset", () => run.frame === 0);
  });
});

test("radius and strength: a second press opens them, they reach the server, [ and ] change the radius", async () => {
  await with_page(async (page, run, at) => {
    const options = page.locator("#pull-options");
    assert.equal(await options.isVisible(), false);
    await page.locator(".tool[data-tool=pull]").click();
    assert.equal(await options.isVisible(), true);
    assert.match(await options.innerText(), /6 cm[^]*40 N/);
    await page.getByRole("slider", { name: "Strength" }).fill("100");
    assert.match(await options.innerText(), /1\.2 kN/);
    await page.locator("#picture").focus();
    await page.keyboard.press("]");
    assert.match(await options.innerText(), /7\.2 cm/);
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down();
    await until("a grip", () => run.pulls.length > 0);
    await page.mouse.up();
    assert.equal(Math.round(run.pulls[0].strength), 1200);
    assert.equal(run.pulls[0].radius.toFixed(3), "0.072");
    await page.locator(".tool[data-tool=probe]").click();
    assert.equal(await options.isVisible(), false);
  });
});

test("the probe tells the state of what is under the pointer, with units", async () => {
  await with_page(async (page, run, at) => {
    const card = page.locator("#probe");
    await page.keyboard.press("2");
    await page.mouse.move(...at(0.5, 0.5));
    await card.waitFor();
    const words = (await card.innerText()).replace(/\s+/g, " ");
    for (const part of [
      "Damage 0.62",
      "Threshold τc 7.6 kPa",
      "Largest stress 5.2 kPa",
      "Speed 0.31 m/s",
      "At rest 0.08, 0.25, 0 m",
      "Particle 12,044, clay",
      "Piece 2",
    ])
      assert.ok(words.includes(part), `${part} in ${words}`);
    await page.mouse.move(...at(0.9, 0.1));
    await card.waitFor({ state: "hidden" });
    await page.locator("#picture").focus();
    await page.keyboard.press("Enter");
    await card.waitFor();
    await page.keyboard.press("1");
    await card.waitFor({ state: "hidden" });
    assert.equal(run.pulls.length, 0);
  });
});

test("a finger pulls, two fingers pinch", async () => {
  await with_page(
    async (page, run, at) => {
      const finger = (kind, id, [clientX, clientY]) =>
        page.locator("#picture").evaluate(
          (canvas, init) => {
            canvas.setPointerCapture = () => {};
            canvas.dispatchEvent(new PointerEvent(init.kind, init));
          },
          {
            kind,
            pointerId: id,
            pointerType: "touch",
            isPrimary: id === 1,
            bubbles: true,
            clientX,
            clientY,
            button: kind === "pointermove" ? -1 : 0,
            buttons: 1,
          },
        );
      await finger("pointerdown", 1, at(0.5, 0.5));
      await until("a grip", () => run.pulls.length > 0);
      const before = eyes(run).at(-1);
      await finger("pointerdown", 2, at(0.7, 0.5));
      await until("released", () => run.pulls.at(-1).radius === 0);
      await finger("pointermove", 2, at(0.9, 0.5));
      await until("closer", () => eyes(run).at(-1) !== before);
      await finger("pointerup", 2, at(0.9, 0.5));
      await finger("pointerup", 1, at(0.5, 0.5));
    },
    { width: 768, height: 1024, touch: true },
  );
});
