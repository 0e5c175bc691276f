// A headless Chromium with a page on the station: what it must never see is an error, whatever is clicked.
//
// npm's packages are those of tests/npm; the browser is Debian's.
import {createRequire} from "node:module";
import {mkdirSync, readFileSync} from "node:fs";
import path from "node:path";
import {fileURLToPath} from "node:url";

const require = createRequire(path.join(path.dirname(fileURLToPath(import.meta.url)), "../../../npm/package.json"));
const puppeteer = require("puppeteer-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const kSizes = [[1280, 800], [390, 844], [1920, 1080]];
const kThemes = ["dark", "light", "red"];

export class WatchedPage {
  shared = {problems: [], pictures: 0};  // of all pages of the browser
  expected = [];                         // what is no problem now

  // `folder`: for the browser's profile and the screenshots.
  static async open(address, folder) {
    const watched = new WatchedPage();
    watched.folder = folder;
    mkdirSync(folder, {recursive: true});
    watched.browser = await puppeteer.launch({
      executablePath: "/usr/bin/chromium",
      userDataDir: path.join(folder, "profile"),
      args: ["--no-sandbox", "--lang=en", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync"],
    });
    await watched.begin(address);
    return watched;
  }

  // Another page of the same browser, as another browser is to the station.
  async another() {
    const watched = Object.assign(new WatchedPage(), {shared: this.shared, folder: this.folder, browser: this.browser});
    await watched.begin(this.address);
    return watched;
  }

  async begin(address) {
    this.address = address;
    this.page = await this.browser.newPage();
    this.watch(address);
    await this.page.setViewport({width: kSizes[0][0], height: kSizes[0][1]});
    await this.page.goto(address, {waitUntil: "load"});
    await this.until("the station's state", () => document.body.dataset.job, 20);
  }

  problem(words) {
    if (!this.expected.some(one => one.test(words))) this.shared.problems.push(words);
  }

  watch(address) {
    const own = new URL(address).origin;
    this.page.on("console", said => {
      if (["error", "warn"].includes(said.type())) this.problem(`console ${said.type()}: ${said.text()}`);
    });
    this.page.on("pageerror", error => this.problem(`script error: ${error.message}`));
    this.page.on("requestfailed", request => this.problem(`failed: ${request.url()} ${request.failure().errorText}`));
    this.page.on("request", request => {
      if (!request.url().startsWith(own) && !request.url().startsWith("data:"))
        this.problem(`asked somebody else: ${request.url()}`);
    });
    this.page.on("response", answer => {
      if (answer.status() >= 400) this.problem(`${answer.status()} for ${answer.url()}`);
    });
  }

  // True as soon as `condition`, a function that runs in the page, is; an error that names `what` when it never is.
  async until(what, condition, seconds, ...values) {
    try {
      await this.page.waitForFunction(condition, {timeout: 1000 * seconds, polling: 100}, ...values);
    } catch (error) {
      throw new Error(`waited ${seconds} s for ${what}: ${error.message}`);
    }
  }

  async text(selector) {
    return this.page.$eval(selector, element => element.textContent.trim());
  }

  // As a person does: what is hidden, covered or disabled cannot be clicked. A page behind another one draws nothing.
  async click(selector) {
    await this.page.bringToFront();
    await this.until(`${selector} to be enabled`, found => {
      const element = document.querySelector(found);
      return element && !element.disabled && element.offsetParent !== null;
    }, 30, selector);
    await this.page.locator(selector).setTimeout(10000).click();
  }

  async type(selector, text) {
    await this.click(selector);
    await this.page.$eval(selector, element => element.select());
    await this.page.keyboard.type(text);
  }

  // The screen as it is now, in every size and theme; accessibility in all themes; nothing wider than the window.
  async look(name) {
    for (const [width, height] of kSizes) {
      await this.page.setViewport({width, height});
      for (const theme of kThemes) {
        await this.setTheme(theme);
        await this.page.screenshot({path: path.join(this.folder, `${name}-${width}-${theme}.png`), fullPage: false});
        this.shared.pictures++;
        const wide = await this.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        if (wide > 0) this.problem(`${name} is ${wide} px wider than a window of ${width} px`);
        if (width === kSizes[0][0]) await this.checkAccess(name, theme);
      }
    }
    await this.setTheme(kThemes[0]);
    await this.page.setViewport({width: kSizes[0][0], height: kSizes[0][1]});
  }

  async setTheme(wanted) {
    await this.page.evaluate(theme => {
      for (let i = 0; i < 3 && document.body.dataset.theme !== theme; i++) document.getElementById("theme").click();
    }, wanted);
  }

  async checkAccess(name, theme) {
    await this.page.evaluate(axe);
    const violations = await this.page.evaluate(() => axe.run().then(found => found.violations.map(
      ({impact, id, nodes}) => ({impact, id, where: nodes.map(node => node.target.join(" ")).join(", ")}))));
    for (const {impact, id, where} of violations)
      this.problem(`${name} (${theme}): ${impact} accessibility: ${id} at ${where}`);
  }

  // What there is to say of it when something has gone wrong.
  async report() {
    const [page] = (await this.browser.pages()).slice(-1);
    await page.screenshot({path: path.join(this.folder, "failure.png"), fullPage: true});
    const state = await page.evaluate(() => fetch("/api/state").then(answer => answer.json()).then(({job}) => job && {...job, lines: job.lines.slice(-2)}, String));
    return JSON.stringify({problems: this.shared.problems, shown: await page.$eval("main", main => main.innerText.slice(0, 400)), state}, null, 1);
  }

  async closePage() {
    this.page.removeAllListeners("requestfailed");  // the event stream ends with the page
    await this.page.close();
  }

  async close() {
    for (const page of await this.browser.pages()) page.removeAllListeners("requestfailed");
    await this.browser.close();
  }
}
