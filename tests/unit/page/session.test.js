import assert from "node:assert/strict";
import { test } from "node:test";
import { Session, signedOut } from "../../../server/static/js/game/session.js";
import "./samples.js"; // the page speaks English

const ME = { name: "Ann", robot: 3 };

/** What a session tells that gets these answers, one for each question. */
async function told(answers, { lost = false } = {}) {
  const heard = [];
  const session = new Session({
    me: ME,
    onEnd: ({ title }, ms) => heard.push([title, ms]),
    onOther: () => heard.push("another tab"),
    ask: async () => {
      const answer = answers.shift();
      if (answer instanceof Error) throw answer;
      return answer;
    },
  });
  session.serverWasLost = lost;
  heard.push(await session.check());
  return heard;
}

test("a session that the server knows goes on", async () => {
  const answer = { status: "OK", user: "Ann", robot: 3, ticket: "t" };
  assert.deepEqual(await told([answer]), [answer]);
});

test("a server that does not answer ends nothing", async () => {
  assert.deepEqual(await told([new Error("network")]), [null]);
});

test("the end says why", async () => {
  assert.deepEqual(await told([{ status: "UNREGISTERED" }]), [["Robot lost", 2500], null]);
  assert.deepEqual(await told([{ status: "UNREGISTERED" }], { lost: true }), [["The game has restarted", 2500], null]);
  assert.deepEqual(await told([{ status: "QUEUED" }]), [["Your turn is over", 4000], null]);
  assert.deepEqual(await told([{ status: "OK", user: "Ann", robot: 4 }]), ["another tab", null]);
});

test("several questions at once are one, and after the end nothing is told", async () => {
  let asked = 0;
  const session = new Session({
    me: ME,
    onEnd: () => assert.fail("it was over already"),
    onOther: () => assert.fail("it was over already"),
    ask: async () => {
      asked += 1;
      return { status: "UNREGISTERED" };
    },
  });
  const answers = [session.check(), session.check()];
  session.end();
  assert.deepEqual(await Promise.all(answers), [null, null]);
  assert.equal(asked, 1);
});

test("what a reply to a sign-out means", () => {
  assert.equal(signedOut({ status: "OK" }, "Ann").isOut, true);
  assert.equal(signedOut({ status: "UNREGISTERED" }, "Ann").message.text, "The server does not know “Ann”.");
  assert.deepEqual(signedOut(null, "Ann"), {
    isOut: false,
    message: { kind: "error", title: "Still signed in", text: "The server does not answer." },
  });
});
