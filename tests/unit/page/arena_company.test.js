import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Company } from "../../../server/static/js/arena/company.js";

let now, asked, timers, drawn, company;

/** Time passes (ms); what is due happens. */
function pass(ms) {
  now += ms;
  for (const timer of timers.splice(0)) {
    if (timer.at <= now) timer.act();
    else timers.push(timer);
  }
}

/** The screen is ready. */
function show() {
  for (const act of asked.splice(0)) act(now);
}

beforeEach(() => {
  [now, asked, timers, drawn] = [0, [], [], []];
  company = new Company(() => now, (act) => asked.push(act), (act, ms) => timers.push({ at: now + ms, act }));
});

test("alone, the next picture is the screen's", () => {
  company.next((at) => drawn.push(at));
  show();
  assert.deepEqual(drawn, [0]);
  assert.equal(company.isThere, false);
});

test("in company, it is drawn with the next one beside it, once", () => {
  company.join();
  company.next((at) => drawn.push(at));
  pass(40);
  show();
  assert.deepEqual(drawn, []);
  company.join();
  show();
  pass(500);
  company.join();
  show();
  assert.deepEqual(drawn, [40]);
});

test("when the company has gone, it does not wait for ever, and then not at all", () => {
  company.join();
  company.next((at) => drawn.push(at));
  pass(160);
  show();
  assert.deepEqual(drawn, [160]);
  assert.equal(company.isThere, false);
  company.next((at) => drawn.push(at));
  show();
  assert.deepEqual(drawn, [160, 160]);
});
