// Parameters, undo, scenes, upload, downloads and view settings, on the mock server.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { open_page, settled, until } from "./browser.mjs";
import { start_mock } from "./mock_server.mjs";

async function with_page(body, page_options = {}) {
  const mock = await start_mock();
  const held = await open_page(mock.url, { calm: true, ...page_options });
  await until("parameters", () => held.page.locator(".hero").count());
  try {
    await body(held.page, mock.run, held);
  } finally {
    await held.close();
    await mock.close();
  }
}
const value_of = (run, id) => run.parameters.find((entry) => entry.id === id).value;

test("a dragged slider sends one change at a time and the newest wins", async () => {
  await with_page(async (page, run) => {
    run.patch_ms = 120;
    const box = await page.locator(".hero .slider").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    const start = Date.now();
    for (let i = 1; i <= 30; i++) {
      await page.mouse.move(box.x + box.width * (0.5 + (0.4 * i) / 30), box.y + box.height / 2);
      await page.waitForTimeout(12);
    }
    await page.mouse.up();
    const shown = Number(await page.locator(".hero .number input").inputValue()) * 1e3;
    await until("the final value", () => value_of(run, "tau_c") === shown);
    await settled(page, 400);
    const most = (Date.now() - start) / (120 + 50) + 2;
    assert.ok(run.patches.length <= most, `${run.patches.length} requests, ${most} have time`);
    assert.equal(run.most_patches_in_flight, 1);
    const order = run.patches.map((values) => Object.values(values)[0]);
    assert.deepEqual(
      order,
      [...order].sort((a, b) => a - b),
    );
    assert.equal(await page.locator("#undo-button").isEnabled(), true);
    await page.keyboard.press("Control+z");
    await until("one undo takes the whole drag back", () => value_of(run, "tau_c") === 2e4);
    assert.equal(await page.locator("#undo-button").isEnabled(), false);
  });
});

test("typed values: units, comma, prefix, and a refusal that keeps the old value", async () => {
  await with_page(async (page, run) => {
    const input = page.locator(".hero .number input");
    const type = async (text) => {
      await input.fill(text);
      await input.press("Enter");
    };
    await type("35");
    await until("35 kPa", () => value_of(run, "tau_c") === 35000);
    await type("12,5");
    await until("12.5 kPa", () => value_of(run, "tau_c") === 12500);
    await type("0.05M");
    await until("0.05 MPa", () => value_of(run, "tau_c") === 50000);
    await type("900");
    assert.equal(await input.inputValue(), "50");
    assert.match(await page.locator(".hero .message").textContent(), /2 to 200 kPa/);
    await type("nonsense");
    assert.equal(value_of(run, "tau_c"), 50000);
    await page.locator(".hero .default").click();
    await until("default", () => value_of(run, "tau_c") === 20000);
    assert.equal(await page.locator(".hero .message").isVisible(), false);
  });
});

test("keys in a slider, and a double click for the default", async () => {
  await with_page(async (page, run) => {
    const smoothing = page.getByRole("slider", { name: "Smoothing" });
    await smoothing.focus();
    await page.keyboard.press("ArrowRight");
    await until("one pass more", () => value_of(run, "smoothing") === 6);
    await page.keyboard.press("PageUp");
    await until("five more", () => value_of(run, "smoothing") === 11);
    await page.keyboard.press("End");
    await until("most", () => value_of(run, "smoothing") === 20);
    assert.equal(await smoothing.getAttribute("aria-valuetext"), "20 passes");
    await smoothing.dblclick();
    await until("default", () => value_of(run, "smoothing") === 5);
    const hero = page.locator(".hero .slider");
    await hero.focus();
    await page.keyboard.press("Shift+ArrowRight");
    await until(
      "a small step moves too",
      () => value_of(run, "tau_c") > 20000 && value_of(run, "tau_c") < 20500,
    );
  });
});

test("a held slider is not moved by the server, a free one is", async () => {
  await with_page(async (page, run) => {
    const box = await page.locator(".hero .slider").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.7, box.y + box.height / 2, { steps: 4 });
    const held = await page.locator(".hero .number input").inputValue();
    await settled(page);
    run.parameters[0].value = 3000;
    run.parameters[1].value = 3e5;
    run.set({ status: "preparing" });
    await page.locator("#preparing").waitFor();
    run.set({ status: "paused" });
    await until(
      "the other follows",
      async () => (await page.getByRole("textbox", { name: "Softening" }).inputValue()) === "300",
    );
    assert.equal(await page.locator(".hero .number input").inputValue(), held);
    await page.mouse.up();
  });
});

test("view settings reach the picture, can be undone, and change the legend", async () => {
  await with_page(async (page, run) => {
    const last = () => run.frame_requests.at(-1);
    await page.locator("#color").selectOption("stress");
    await until("stress", () => last().color === "stress");
    await until("its range", async () =>
      /kPa/.test(await page.locator("#legend-caption").textContent()),
    );
    assert.deepEqual(await page.locator("#legend-ends b").allTextContents(), ["0", "10", "20"]);
    await page.getByRole("radio", { name: "Particles" }).check({ force: true });
    await until("particles", () => last().mode === "particles");
    await page.locator("#undo-button").click();
    await page.locator("#undo-button").click();
    await until("as before", () => last().mode === "surface" && last().color === "damage");
    await page.emulateMedia({ colorScheme: "dark" });
    await until("dark", () => last().theme === "dark");
  });
});

test("scenes load from the gallery with their thumbnails", async () => {
  await with_page(async (page, run) => {
    await until("thumbnails", async () => (await page.locator(".scene img").count()) === 5);
    await page.locator(".scene", { hasText: "Twisted bar" }).click();
    await until("the scene", () => run.scene === "twist");
    await until(
      "its name",
      async () => (await page.locator("#scene-title").textContent()) === "Twisted bar",
    );
    assert.equal(
      await page.locator(".scene[aria-current=true] .title").textContent(),
      "Twisted bar",
    );
    assert.equal(await page.title(), "rend: Twisted bar");
  });
});

test("title, view and sliders of another scene come when it has been prepared", async () => {
  await with_page(async (page, run) => {
    await until("a picture", () => run.frame_requests.length);
    run.set({ scene: "twist", bare: true, status: "preparing", progress: { stage: "particles", share: 0.1 } });
    await page.locator("#preparing").waitFor();
    assert.equal(await page.locator("#scene-note").textContent(), "");
    run.set({ bare: false, status: "paused", progress: null, view: { color: "stress", mode: "particles" } });
    await until(
      "its name",
      async () => (await page.locator("#scene-title").textContent()) === "Twisted bar",
    );
    assert.match(await page.locator("#scene-note").textContent(), /270 degrees/);
    await until("its view", () => {
      const { color, mode } = run.frame_requests.at(-1);
      return color === "stress" && mode === "particles";
    });
    assert.equal(await page.locator("[name=view-mode]:checked").inputValue(), "particles");
  });
});

test("a mesh by drop is sent and opened, a bad one refused with its reason", async () => {
  await with_page(async (page, run, { troubles }) => {
    const drop = (name, text) =>
      page.evaluate(
        ([file_name, content]) => {
          const carried = new DataTransfer();
          carried.items.add(new File([content], file_name));
          for (const kind of ["dragover", "drop"]) {
            document
              .querySelector("main")
              .dispatchEvent(
                new DragEvent(kind, { bubbles: true, cancelable: true, dataTransfer: carried }),
              );
          }
        },
        [name, text],
      );
    await drop("duck.obj", "v 0 0 0");
    await until("loaded", () => run.scene === "duck");
    assert.deepEqual(troubles, []);
    await drop("open.stl", "a hole");
    await until("refused", async () =>
      /3 holes/.test(await page.locator("#upload-note").textContent()),
    );
    assert.equal(run.scene, "duck");
    assert.equal(await page.locator("#veil").isVisible(), false);
  });
});

test("downloads: picture, mesh and table", async () => {
  await with_page(async (page, run) => {
    run.set({ frame: 31 });
    await until("frame 31", async () => (await page.locator("#read-frame").textContent()) === "31");
    const download = async (click) => {
      const [file] = await Promise.all([page.waitForEvent("download"), click()]);
      return file;
    };
    const picture = await download(() => page.locator("#save-button").click());
    assert.equal(picture.suggestedFilename(), "tear-0031.png");
    await page.locator("#export-button").click();
    const mesh = await download(() => page.locator("#export-mesh").click());
    assert.equal(mesh.suggestedFilename(), "tear-0031.ply");
    await page.locator("#export-button").click();
    await page.locator("#export-format").selectOption("glb");
    const other = await download(() => page.locator("#export-mesh").click());
    assert.equal(other.suggestedFilename(), "tear-0031.glb");
    let lines;
    await until("a head and frames 0 to 31", async () => {
      await page.locator("#export-button").click();
      const table = await download(() => page.locator("#export-table").click());
      lines = (await readFile(await table.path(), "utf8")).trim().split("\n");
      return lines.length === 33;
    });
    assert.ok(lines[0].startsWith("frame,time,"));
  });
});

test("all frames: an archive, how far it is, cancelling, and why it failed", async () => {
  await with_page(async (page, run) => {
    const text = (id) => page.locator(id).textContent();
    run.set({ frame: 4 });
    await until("frame 4", async () => (await page.locator("#read-frame").textContent()) === "4");
    await page.locator("#export-button").click();
    await page.getByLabel("All", { exact: true }).check();
    assert.match(await text("#export-picture-note"), /PNG of frames 0 to 4, 1920 × \d+, in a ZIP/);
    run.export_held = true;
    await page.locator("#export-picture").click();
    await until("progress", async () => /Frame 1 of 5, 2 s left/.test(await text("#export-job")));
    const downloaded = page.waitForEvent("download");
    run.export_held = false;
    const file = await downloaded;
    assert.equal(file.suggestedFilename(), "tear-png.zip");
    assert.match(await text("#toast"), /tear-png.zip, 48.2 MB/);
    assert.equal(await page.locator("#export-job").isVisible(), false);
    const [{ format, first, last, w, eye }] = run.orders;
    assert.deepEqual([format, first, last, w, eye.split(",").length], ["png", 0, 4, 1920, 3]);

    run.set({ frame: 90 });
    await page.locator("#export-format").selectOption("vtp");
    await until("the new range", async () => /VTP of frames 0 to 90/.test(await text("#export-mesh-note")));
    run.export_held = true;
    await page.locator("#export-mesh").click();
    await until("a job", () => page.locator("#export-job").isVisible());
    await page.locator("#export-picture").click();
    await until("a refusal", async () => /Another export/.test(await text("#toast")));
    assert.equal(await page.locator("#export-job").isVisible(), true, "the first job goes on");
    await page.locator("#export-cancel").click();
    await until("cancelled", async () => /cancelled/.test(await text("#toast")));
    assert.equal(await page.locator("#export-job").isVisible(), false);
    await page.locator("#export-mesh").click();
    await until("another job", () => run.exported.id === 3);
    run.exported.status = "failed";
    await until("the reason", async () => /failed: the disk is full/.test(await text("#toast")));

    await page.locator("#export-mesh").click();
    await until("a fourth job", () => run.exported.id === 4 && run.exported.done);
    await page.reload();
    await page.locator("#export-button").click();
    await until("the job goes on", async () => /Frame 1 of 91/.test(await text("#export-job")));
    run.exported.done = 90;
    run.export_held = false;
    await until("it is ready", async () => /tear-vtp.zip is ready/.test(await text("#toast")));
    const saved = page.waitForEvent("download");
    await page.locator("#toast button").click();
    assert.equal((await saved).suggestedFilename(), "tear-vtp.zip");
  });
});

test("folded panels are remembered", async () => {
  await with_page(async (page) => {
    await page.locator("#gallery-button").click();
    assert.equal(await page.locator("#gallery-button").getAttribute("aria-expanded"), "false");
    await page.reload();
    assert.equal(
      await page.locator("body").evaluate((node) => node.classList.contains("slim")),
      true,
    );
  });
});
