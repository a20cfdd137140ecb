// node check_page.mjs AXE_JS PAGE...: the part of scripts/check_page that controls the browser.
import {spawn} from "node:child_process";
import {readFileSync} from "node:fs";
import {pathToFileURL} from "node:url";

const [axe_file, ...pages] = process.argv.slice(2);
const kWidths = [1280, 360];  // the narrowest phones have 360 to 375 px
const kTable = 521;           // narrower screens show the table of frames as blocks
const kSettle_ms = 1500;

// Chromium's DevTools protocol over a pipe: messages end with a zero byte.
const browser = spawn(
    "chromium",
    ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "about:blank"],
    {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
const waiting = new Map();
const events = [];
let buffer = "", last_id = 0, session;
browser.stdio[4].on("data", (data) => {
  buffer += data;
  for (let end; (end = buffer.indexOf("\0")) >= 0; buffer = buffer.slice(end + 1)) {
    const message = JSON.parse(buffer.slice(0, end));
    if (message.id) waiting.get(message.id)(message);
    else events.push(message);
  }
});
const send = (method, params = {}) => new Promise((resolve, reject) => {
  const id = ++last_id;
  waiting.set(id, (message) => message.error ? reject(new Error(`${method}: ${message.error.message}`))
                                             : resolve(message.result));
  const target = session ? {sessionId: session} : {};
  browser.stdio[3].write(JSON.stringify({id, method, params, ...target}) + "\0");
});
const evaluate = async (expression) => {
  const {result, exceptionDetails} =
      await send("Runtime.evaluate", {expression, awaitPromise: true, returnByValue: true});
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? "no result");
  return result.value;
};

const errors_of = (messages) => messages.flatMap(({method, params}) => {
  if (method === "Runtime.exceptionThrown") return [params.exceptionDetails.text];
  if (method === "Log.entryAdded" && params.entry.level === "error") return [params.entry.text];
  if (method === "Network.requestWillBeSent" && !/^(file|data):/.test(params.request.url))
    return [`asks the network for ${params.request.url}`];
  return [];
});

const check = async (page, width, scheme) => {
  await send("Emulation.setDeviceMetricsOverride",
             {width, height: 900, deviceScaleFactor: 1, mobile: width < 600});
  await send("Emulation.setEmulatedMedia",
             {features: [{name: "prefers-color-scheme", value: scheme}]});
  events.length = 0;
  await send("Page.navigate", {url: pathToFileURL(page).href});
  await new Promise((resolve) => setTimeout(resolve, kSettle_ms));
  const found = errors_of(events);
  const wide = await evaluate("document.documentElement.scrollWidth");
  if (wide > width) found.push(`is ${wide} px wide on a screen of ${width} px`);
  const clipped = await evaluate(`(() => {
    const scroll = document.querySelector("#frames-table")?.parentElement;
    return scroll && scroll.scrollWidth > scroll.clientWidth ? scroll.scrollWidth - scroll.clientWidth : 0;
  })()`);
  if (width < kTable && clipped > 0) found.push(`cuts off ${clipped} px of the table of frames`);
  await evaluate("document.querySelectorAll('details').forEach((d) => (d.open = true))");
  await evaluate(readFileSync(axe_file, "utf8") + ";0");
  const violations = JSON.parse(await evaluate(
      "axe.run(document, {resultTypes: ['violations']}).then((r) => JSON.stringify(r.violations))"));
  for (const {id, help, nodes} of violations)
    found.push(`${id}: ${help} (${nodes.length}, the first: ${nodes[0].target.join(" ")}: ` +
               `${nodes[0].failureSummary.replace(/\s+/g, " ").slice(0, 240)})`);
  return found;
};

let wrong = 0;
try {
  const {targetId} = await send("Target.createTarget", {url: "about:blank"});
  ({sessionId: session} = await send("Target.attachToTarget", {targetId, flatten: true}));
  for (const domain of ["Page", "Runtime", "Log", "Network"]) await send(`${domain}.enable`);
  for (const page of pages)
    for (const width of kWidths)
      for (const scheme of ["light", "dark"])
        for (const text of await check(page, width, scheme)) {
          console.log(`${page} (${width} px, ${scheme}): ${text}`);
          ++wrong;
        }
  console.log(`${pages.length} page${pages.length === 1 ? "" : "s"}, ${wrong} faults`);
} finally {
  browser.kill();
}
process.exit(wrong > 0 ? 1 : 0);
