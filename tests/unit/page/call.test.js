import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { OfferCall } from "../../../server/static/js/lobby/call.js";

const WORDS = { title: "Robot 1 is yours!", text: "Take it within 20 s", tab: "(20 s) Robot 1 is yours!" };
let felt, page, open, mayNotify, call;

beforeEach(() => {
  felt = [];
  page = { title: "Login" };
  open = [];
  mayNotify = true;
  call = new OfferCall({
    speaker: { play: (name) => felt.push(`play ${name}`) },
    vibrate: (pattern) => felt.push(`vibrate ${pattern}`),
    page,
    notify: (title, text) => {
      if (!mayNotify) return null;
      open.push(`${title} ${text}`);
      return { close: () => open.pop() };
    },
  });
});

test("an offer is heard, felt, in the title and told once", () => {
  call.call(WORDS, 1000);
  assert.deepEqual(felt, ["play offer", "vibrate 200,100,200"]);
  assert.equal(page.title, WORDS.tab);
  assert.deepEqual(open, ["Robot 1 is yours! Take it within 20 s"]);
});

test("it calls again while it stands, and the title counts", () => {
  for (let second = 0; second < 8; second++) call.call({ ...WORDS, tab: `${20 - second}` }, 1000 * second);
  assert.equal(felt.filter((one) => one === "play offer").length, 2);
  assert.equal(page.title, "13");
  assert.equal(open.length, 1);
});

test("who looks away later is told then", () => {
  mayNotify = false;
  call.call(WORDS, 0);
  mayNotify = true;
  call.call(WORDS, 1000);
  assert.deepEqual(open, []);
  call.call(WORDS, 4000);
  assert.equal(open.length, 1);
});

test("nothing of it is left once it is taken or missed", () => {
  call.end();
  assert.deepEqual(felt, []);
  call.call(WORDS, 0);
  felt = [];
  call.end();
  assert.equal(page.title, "Login");
  assert.deepEqual(open, []);
  assert.deepEqual(felt, ["vibrate "]);
  call.call(WORDS, 100);
  assert.equal(open.length, 1, "the next offer calls at once");
});
