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

  /// A place in the window under which there is matter.
  const place_of_body = async (page) => {
    const box = await page.locator("#picture").boundingBox();
    for (let i = 0; i < 60; i++) {
      const x = 0.5 + 0.3 * Math.sin(i * 2.4) * (i / 60),
        y = 0.5 + 0.2 * Math.cos(i * 2.4) * (i / 60);
      await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
      const found = await page.evaluate(async ([sx, sy]) => {
        const seen = performance
          .getEntriesByType("resource")
          .filter(({ name }) => name.includes("/api/frame.jpg"))
          .at(-1);
        const query = new URL(seen.name).searchParams;
        for (const [key, value] of [["x", sx], ["y", sy], ["frame", "live"]]) query.set(key, value);
        for (const key of ["after", "wait"]) query.delete(key);
        return (await (await fetch(`/api/probe?${query}`)).json()).matter !== null;
      }, [x, y]);
      if (found) return { x: box.x + x * box.width, y: box.y + y * box.height };
    }
    throw new Error("no matter in sight");
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
    const beside = { x: box.x + box.width / 2, y: box.y + box.height * 0.06 };
    await page.mouse.move(beside.x, beside.y);
    await page.mouse.down();
    await page.mouse.move(beside.x + 90, beside.y + 20, { steps: 6 });
    await page.mouse.up();
    await until("a still of the turned view", () => eyes.length >= 2);
    const turned = eyes.at(-1);
    await page.locator("#fit-button").click();
    await until("the scene's own view", () => eyes.at(-1) !== turned);
  });

  test("pulling at the body plays and shows its force, probing tells its state, a copied link its place", async () => {
    const page = await ready();
    await reset(page);
    const body = await place_of_body(page);
    await page.keyboard.press("1");
    await page.mouse.move(body.x, body.y);
    await page.mouse.down();
    await page.mouse.move(body.x + 30, body.y - 60, { steps: 5 });
    await until("a force", async () =>
      /[1-9].* k?N/.test((await page.locator("#grip-force").textContent()) ?? ""), FRAME_MS);
    await until("time goes on", async () => (await frame_of(page)) >= 1, FRAME_MS);
    await picture_of(page, `${prefix}pulling`);
    await page.mouse.up();
    await until("let go", () => page.locator("#grip").evaluate((node) => node.hasAttribute("hidden")));
    await pause(page);
    await page.keyboard.press("2");
    const again = await place_of_body(page);
    await page.mouse.move(again.x, again.y);
    await until("a card", () => page.locator("#probe").isVisible());
    assert.match(await page.locator("#probe").innerText(), /Threshold[^]*Pa[^]*At rest[^]* m/);
    await picture_of(page, `${prefix}probing`);
    await page.keyboard.press("1");
    await until("no card", async () => !(await page.locator("#probe").isVisible()));
    await page.locator("#link-button").click();
    await until("a link", async () => /#scene=.*eye=/.test(page.url()));
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
