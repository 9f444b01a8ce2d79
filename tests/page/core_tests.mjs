// What must hold on any server, the program's own included.
import assert from "node:assert/strict";
import { test } from "node:test";
import { frame_of, open_page, picture_of, play_label, settled, until } from "./browser.mjs";

const PREPARING_MS = 120000;
const FRAME_MS = 60000;

/// `url()` gives the server; `prefix` names the screenshots.
export function core_tests(url, prefix) {
  let held;
  const ready = async () => {
    held ??= await open_page(url());
    return held.page;
  };
  const pause = async (page) => {
    if ((await play_label(page)) === "Pause") await page.locator("#play-button").click();
    await until("paused", async () => (await play_label(page)) === "Play");
  };
  const reset = async (page) => {
    await page.locator("#reset-button").click();
    await until("frame 0", async () => (await frame_of(page)) === 0, FRAME_MS);
    await until(
      "paused",
      async () => /Paused/.test(await page.locator("#mode").textContent()),
      FRAME_MS,
    );
  };

  test("the page loads, shows a picture and the run plays", async () => {
    const page = await ready();
    await until(
      "a picture",
      () => page.evaluate(() => !document.querySelector("#picture").classList.contains("empty")),
      PREPARING_MS,
    );
    const { width, colors } = await page.evaluate(() => {
      const canvas = document.querySelector("#picture");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const seen = new Set();
      for (let i = 0; i < data.length; i += 404)
        seen.add(((data[i] >> 4) << 8) | ((data[i + 1] >> 4) << 4) | (data[i + 2] >> 4));
      return { width: canvas.width, colors: seen.size };
    });
    assert.ok(width > 100, `picture is ${width} pixels wide`);
    assert.ok(colors > 8, `picture has ${colors} colours`);
    await until("frames advance", async () => (await frame_of(page)) >= 2, FRAME_MS);
    await picture_of(page, `${prefix}playing`);
  });

  test("Pause stops the frames, Step adds exactly one", async () => {
    const page = await ready();
    await pause(page);
    await until(
      "a paused run",
      async () => {
        const before = await frame_of(page);
        await settled(page, 1200);
        return before === (await frame_of(page));
      },
      FRAME_MS,
    );
    const before = await frame_of(page);
    await page.locator("#step-button").click();
    await until("one more", async () => (await frame_of(page)) === before + 1, FRAME_MS);
    await settled(page, 1200);
    assert.equal(await frame_of(page), before + 1);
  });

  test("scrubbing shows recorded frames and a release beyond them snaps back", async () => {
    const page = await ready();
    const newest = await frame_of(page);
    await page.locator("#scrub").focus();
    await page.keyboard.press("Home");
    await until("frame 0", async () => (await frame_of(page)) === 0);
    assert.match(await page.locator("#mode").textContent(), /Recorded/);
    await page.keyboard.press("ArrowRight");
    assert.equal(await frame_of(page), 1);
    const box = await page.locator("#scrub").boundingBox();
    await page.mouse.click(box.x + box.width - 12, box.y + 16);
    await until("newest again", async () => (await frame_of(page)) === newest);
    assert.equal(await page.locator("#scrub").inputValue(), String(newest));
  });

  test("the yield threshold reaches the server", async () => {
    const page = await ready();
    const label = await page.locator(".hero > label").textContent();
    assert.ok(label.length > 3, "the hero parameter has a name");
    const answered = page.waitForResponse(
      (r) => r.request().method() === "PATCH" && r.url().includes("/api/parameters"),
    );
    await page.locator(".hero .slider").focus();
    await page.keyboard.press("ArrowLeft");
    const response = await answered;
    assert.equal(response.status(), 200);
    const sent = Object.entries(JSON.parse(response.request().postData()).values);
    assert.equal(sent.length, 1);
    await until("the server holds the value", () =>
      page.evaluate(async ([id, value]) => {
        const { parameters } = await (await fetch("/api/parameters")).json();
        return Math.abs(parameters.find((p) => p.id === id).value / value - 1) < 1e-6;
      }, sent[0]),
    );
    assert.equal(
      await page.locator(".hero").evaluate((node) => node.classList.contains("changed")),
      true,
    );
    await page.locator(".hero .default").click();
    await until(
      "default again",
      async () =>
        !(await page.locator(".hero").evaluate((node) => node.classList.contains("changed"))),
    );
  });

  test("turning the view asks for other pictures and Fit returns", async () => {
    const page = await ready();
    const eye_of = (request) => new URL(request.url()).searchParams.get("eye");
    const eyes = [];
    page.on("request", (request) => {
      if (request.url().includes("/api/frame.jpg")) eyes.push(eye_of(request));
    });
    const box = await page.locator("#picture").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + 90, box.y + box.height / 2 + 20, { steps: 6 });
    await page.mouse.up();
    await until("a still of the turned view", () => eyes.length >= 2);
    const turned = eyes.at(-1);
    await page.locator("#fit-button").click();
    await until("the scene's own view", () => eyes.at(-1) !== turned);
  });

  test("Reset goes back to frame 0 and Space plays again", async () => {
    const page = await ready();
    await reset(page);
    await page.locator("#picture").click({ position: { x: 40, y: 200 } });
    await page.keyboard.press(" ");
    await until("frames advance", async () => (await frame_of(page)) >= 1, FRAME_MS);
    await page.keyboard.press(" ");
    await until("paused", async () => (await play_label(page)) === "Play");
    await picture_of(page, `${prefix}paused`);
  });

  test("nothing in the console, nothing fetched from elsewhere", async () => {
    await ready();
    assert.deepEqual(held.troubles, []);
    await held.close();
  });
}
