// Transport, Space and keys, replay and the picture's requests, on the mock server.
import assert from "node:assert/strict";
import { test } from "node:test";
import { frame_of, open_page, play_label, settled, until } from "./browser.mjs";
import { start_mock } from "./mock_server.mjs";

async function with_page(options, body) {
  const mock = await start_mock(options.mock);
  Object.assign(mock.run, options.run);
  const held = await open_page(mock.url, { calm: true, ...options.page });
  await until("parameters", () => held.page.locator(".hero").count());
  await until("a picture", () => mock.run.frame_requests.length > 0);
  try {
    await body(held.page, mock.run, held);
    assert.deepEqual(held.troubles, []);
  } finally {
    await held.close();
    await mock.close();
  }
}

/// Waits until the page asks for no picture any more.
async function at_rest(run, milliseconds = 400) {
  await until("a view at rest", async () => {
    const asked = run.frame_requests.length;
    await new Promise((done) => setTimeout(done, milliseconds));
    return run.frame_requests.length === asked;
  });
}
/// A slow replay is seen on a busy machine too.
const replay_at = (page, speed) => page.locator("#speed").selectOption(speed);

test("starts by itself, but not for who asked for less motion", async () => {
  await with_page({}, async (page, run) => {
    await settled(page, 600);
    assert.deepEqual(run.actions, []);
  });
  await with_page({ page: { calm: false } }, async (page, run) => {
    await until("play", () => run.actions.some(({ name }) => name === "play"));
    await page.locator("#play-button").click();
    await until("paused", () => run.status === "paused");
    const plays = run.actions.filter(({ name }) => name === "play").length;
    await page.reload();
    await until("parameters", () => page.locator(".hero").count());
    await settled(page, 600);
    assert.equal(
      run.actions.filter(({ name }) => name === "play").length,
      plays,
      "a reload does not start a paused run",
    );
  });
});

test("Space after a mouse click plays or pauses, whatever was clicked", async () => {
  await with_page({ run: { frame: 20 } }, async (page, run) => {
    await page.locator("#loop-button").click();
    assert.equal(await page.locator("#loop-button").getAttribute("aria-pressed"), "true");
    await page.keyboard.press(" ");
    await until("playing", () => run.status === "playing");
    assert.equal(await page.locator("#loop-button").getAttribute("aria-pressed"), "true");
    await page.keyboard.press(" ");
    await until("paused", () => run.status === "paused");
    const slider = page.locator(".hero .slider");
    await slider.click();
    await page.keyboard.press(" ");
    await until("playing from a slider", () => run.status === "playing");
    await page.keyboard.press(" ");
    await until("paused", () => run.status === "paused");
  });
});

test("Space on a button reached by Tab presses that button", async () => {
  await with_page({ run: { frame: 20 } }, async (page, run) => {
    await page.locator("#step-button").focus();
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "loop-button");
    await page.keyboard.press(" ");
    assert.equal(await page.locator("#loop-button").getAttribute("aria-pressed"), "true");
    assert.equal(run.status, "paused");
  });
});

test("Space in a typed value does not play", async () => {
  await with_page({}, async (page, run) => {
    await page.locator(".hero .number input").click();
    await page.keyboard.press("End");
    await page.keyboard.press(" ");
    await settled(page);
    assert.equal(run.status, "paused");
  });
});

test("keys move in time, and the switch turns single keys off", async () => {
  await with_page({ run: { frame: 40 } }, async (page, run) => {
    await page.keyboard.press("ArrowLeft");
    await until("39", async () => (await frame_of(page)) === 39);
    await page.keyboard.press("Shift+ArrowLeft");
    await until("29", async () => (await frame_of(page)) === 29);
    await page.keyboard.press("Shift+ArrowRight");
    await until("39", async () => (await frame_of(page)) === 39);
    await page.keyboard.press("Home");
    await until("0", async () => (await frame_of(page)) === 0);
    await page.keyboard.press("End");
    await until("40", async () => (await frame_of(page)) === 40);
    await page.keyboard.press("ArrowRight");
    await until("41", async () => (await frame_of(page)) === 41);
    assert.deepEqual(run.actions, [{ name: "step", frames: 1 }]);
    await page.keyboard.press("l");
    assert.equal(await page.locator("#loop-button").getAttribute("aria-pressed"), "true");
    await page.keyboard.press("+");
    assert.equal(await page.locator("#speed").inputValue(), "2");
    await page.keyboard.press("h");
    assert.equal(await page.locator("#side").isVisible(), false);
    await page.keyboard.press("h");
    await page.keyboard.press("?");
    await page.locator("#single-keys").uncheck();
    await page.keyboard.press("Escape");
    assert.equal(await page.locator("#help").isVisible(), false);
    await page.keyboard.press("l");
    assert.equal(await page.locator("#loop-button").getAttribute("aria-pressed"), "true");
    await page.keyboard.press("r");
    await settled(page);
    assert.equal(run.frame, 41, "R is a single key too");
  });
});

test("replay runs through recorded frames and then goes on live", async () => {
  await with_page({ run: { frame: 60 } }, async (page, run) => {
    await page.keyboard.press("Home");
    await replay_at(page, "0.25");
    await page.locator("#play-button").click();
    await until("replay", async () => /Replay/.test(await page.locator("#mode").textContent()));
    assert.equal(run.status, "paused", "recorded frames need no simulation");
    await replay_at(page, "4");
    await until("live", () => run.status === "playing");
    await until("new frames", async () => (await frame_of(page)) > 60);
  });
});

test("Play at the very end starts again from the record, with Loop for ever", async () => {
  await with_page(
    { mock: { frames: 40 }, run: { frame: 40, status: "finished" } },
    async (page, run) => {
      await until("the last frame", async () => (await frame_of(page)) === 40);
      await replay_at(page, "0.25");
      await page.locator("#play-button").click();
      await until("an early frame", async () => (await frame_of(page)) < 25);
      await replay_at(page, "4");
      await until(
        "the end",
        async () => (await frame_of(page)) === 40 && (await play_label(page)) === "Play",
      );
      await page.locator("#loop-button").click();
      await replay_at(page, "1");
      await page.locator("#play-button").click();
      await until("an early frame", async () => (await frame_of(page)) < 20);
      await until("late", async () => (await frame_of(page)) > 25);
      await until("early again", async () => (await frame_of(page)) < 20);
      assert.equal(await play_label(page), "Pause");
      assert.equal(run.frame, 40);
    },
  );
});

test("scrubbing pauses a playing run", async () => {
  const slow = { mock: { frame_ms: 1000 }, run: { frame: 30, status: "playing" } };
  await with_page(slow, async (page, run) => {
    const box = await page.locator("#scrub").boundingBox();
    await page.mouse.move(box.x + box.width * 0.2, box.y + 16);
    await page.mouse.down();
    await until("paused", () => run.status === "paused");
    await page.mouse.move(box.x + box.width * 0.1, box.y + 16, { steps: 8 });
    await until("frame 12 or near", async () => Math.abs((await frame_of(page)) - 12) <= 2);
    await page.mouse.up();
    assert.match(await page.locator("#mode").textContent(), /Recorded/);
  });
});

test("at most one picture in flight; small and fast while turning, a full still after", async () => {
  await with_page({ run: { frame: 30 } }, async (page, run) => {
    await until("a still", () => run.frame_requests.at(-1).quality === "still");
    await at_rest(run);
    const full = Number(run.frame_requests.at(-1).w),
      count = run.frame_requests.length;
    const in_flight = new Set();
    let most_in_flight = 0;
    run.picture_ms = 100;
    const is_picture = (request) => request.url().includes("/api/frame.jpg");
    page.on("request", (request) => {
      if (is_picture(request)) in_flight.add(request);
      most_in_flight = Math.max(most_in_flight, in_flight.size);
    });
    for (const end of ["requestfinished", "requestfailed"])
      page.on(end, (request) => in_flight.delete(request));
    const box = await page.locator("#picture").boundingBox();
    await page.mouse.move(box.x + 300, box.y + 40);
    await page.mouse.down();
    let moves = 0;
    await until("pictures come while turning", async () => {
      moves++;
      await page.mouse.move(box.x + 300 + 4 * (moves % 60), box.y + 40 + moves % 60);
      return moves >= 12 && run.frame_requests.length >= count + 3;
    });
    await page.mouse.up();
    const last_drag = run.frame_requests.at(-1);
    await until("a still again", () => run.frame_requests.at(-1).quality === "still");
    const during = run.frame_requests.slice(count, -1);
    assert.ok(
      during.every(({ quality, w }) => quality === "fast" && Number(w) <= full / 2 + 2),
      "small and fast",
    );
    assert.equal(Number(run.frame_requests.at(-1).w), full);
    assert.notEqual(last_drag.eye, during[0].eye);
    assert.equal(most_in_flight, 1);
    await at_rest(run, 1000);
  });
});

test("wheel, keys and two fingers move the camera", async () => {
  await with_page({ run: { frame: 30 }, page: { touch: true } }, async (page, run) => {
    const distance = () => {
      const { eye, target } = run.frame_requests.at(-1);
      const [a, b] = [eye, target].map((text) => text.split(",").map(Number));
      return Math.hypot(...a.map((x, i) => x - b[i]));
    };
    const target = () => run.frame_requests.at(-1).target;
    await page.locator("#fit-button").click();
    await at_rest(run);
    const far = distance(),
      home = target();
    const box = await page.locator("#picture").boundingBox();
    await page.mouse.move(box.x + 300, box.y + 40);
    await page.mouse.wheel(0, -240);
    await until("closer", () => distance() < far * 0.95);
    await page.locator("#picture").focus();
    await page.keyboard.press("-");
    await page.keyboard.press("Shift+ArrowLeft");
    await until("moved", () => target() !== home);
    await page.locator("#fit-button").click();
    await until("home", () => target() === home && Math.abs(distance() / far - 1) < 1e-4);

    const fingers = await page.context().newCDPSession(page);
    const touch = (type, ...points) =>
      fingers.send("Input.dispatchTouchEvent", {
        type,
        touchPoints: points.map(([x, y], id) => ({ x: box.x + x, y: box.y + y, id })),
      });
    await touch("touchStart", [250, 300]);
    await touch("touchStart", [250, 300], [350, 300]);
    for (let i = 1; i <= 6; i++) await touch("touchMove", [250 - 10 * i, 300], [350 + 10 * i, 300]);
    await touch("touchEnd");
    await until("pinched closer", () => distance() < far * 0.7);
  });
});
