// One Chromium for all tests; pages with the watches that every test wants.
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { after } from "node:test";
import { chromium } from "playwright-core";

export const real_url = process.env.REND_URL;
const artifacts = process.env.REND_ARTIFACTS ?? process.argv[2];
if (artifacts) mkdirSync(artifacts, { recursive: true });

export const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
  ],
});
// An open Chromium keeps Node alive, whichever files of tests it runs.
after(() => browser.close());

/// {page, troubles, close()}: `troubles` collects console errors, page errors and requests to elsewhere.
export async function open_page(
  url,
  { width = 1440, height = 900, scheme = "light", calm = false, touch = false } = {},
) {
  const context = await browser.newContext({
    viewport: { width, height },
    colorScheme: scheme,
    reducedMotion: calm ? "reduce" : "no-preference",
    hasTouch: touch,
    acceptDownloads: true,
  });
  const page = await context.newPage();
  page.setDefaultTimeout(20000);
  const troubles = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) troubles.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => troubles.push(`page: ${error.message}`));
  page.on("request", (request) => {
    const { protocol, origin } = new URL(request.url());
    if (protocol.startsWith("http") && origin !== new URL(url).origin)
      troubles.push(`foreign: ${request.url()}`);
  });
  await page.goto(url);
  return { page, troubles, close: () => context.close() };
}

export async function picture_of(page, name) {
  if (artifacts) await page.screenshot({ path: join(artifacts, `${name}.png`) });
}

/// How many times longer to wait than usual: sanitizers slow the program down.
export const patience = Number(process.env.REND_TEST_PATIENCE ?? 1);

/// Waits until `check()` is true and says what was waited for when it never is.
export async function until(what, check, milliseconds = 15000) {
  const end = Date.now() + patience * milliseconds;
  while (Date.now() < end) {
    if (await check()) return;
    await new Promise((done) => setTimeout(done, 30));
  }
  throw new Error(`waited in vain: ${what}`);
}

export const frame_of = async (page) => Number(await page.locator("#read-frame").textContent());
export const play_label = (page) => page.locator("#play-button").getAttribute("aria-label");
/// The page of a mock run that stands still knows its newest state.
export const caught_up = (run) => until("the newest state", () => run.heard === run.revision);
export const settled = (page, milliseconds = 350) => page.waitForTimeout(milliseconds);
