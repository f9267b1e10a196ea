// The operator's desk: what is going on, and what an operator may do about it.

import * as api from "./operator_api.js";
import * as dialogs from "./dialogs.js";
import { RulesForm, WordsForm } from "./operator_forms.js";
import { TestDrive } from "./operator_drive.js";
import { INTERVAL, Poll } from "./operator_poll.js";
import * as view from "./operator_view.js";
import { ADDED_TIME } from "./operator_words.js";

const byId = (id) => document.getElementById(id);

const rules = new RulesForm((name) => act(() => api.setRules({ [name]: null }), () => rules.forget(name)));
const words = new WordsForm();
const drive = new TestDrive();

const poll = new Poll({
  ask: api.state,
  now: Date.now,
  onState: (state) => {
    view.showLost(null);
    view.showState(state, on);
    rules.show(state.rules);
    words.show(state.names.words);
    const driven = state.robots.find(({ id }) => id === drive.robot);
    if (!driven || driven.in_service) drive.stop();
  },
  onLost: view.showLost,
  onSignedOut: () => location.reload(), // the server answers with its login
});

/** Do what somebody has asked for; say why when it cannot be done. Afterwards the desk shows what has become of it. */
async function act(order, then = () => {}) {
  try {
    await order();
    view.showProblem("");
    then();
  } catch (error) {
    if (error.status === 401) location.reload();
    view.showProblem(error.status ? error.message : "The server does not answer. Look whether it has been done, then try again.");
  }
  await poll.refresh();
}

/** Do it once somebody has said yes. */
async function confirm({ title, text, ok }, order, then) {
  if (await dialogs.show({ kind: "warning", title, text, ok, cancel: "Cancel", calm: true })) await act(order, then);
}

const on = {
  service: (id, inService) => act(() => api.setService(id, inService)),
  drive: (id) => act(() => drive.start(id)),
  signOut: (name) =>
    confirm({ title: `Sign ${name} out?`, text: "The robot passes on to the next one.", ok: "Sign out" }, () => api.signOut(name)),
  ban: (name, then) =>
    confirm(
      { title: `Ban ${name}?`, text: "Who has this name is signed out, and nobody can take it again.", ok: "Ban" },
      () => api.names({ ban: name }),
      then,
    ),
  unban: (name) => act(() => api.names({ unban: name })),
};

function order(action) {
  if (action === "add_time") return act(() => api.battle({ action, seconds: ADDED_TIME }));
  const send = () => api.battle({ action });
  if (action !== "abort") return act(send);
  return confirm({ title: "Abort the battle?", text: "It ends at once and nobody wins. All players are not ready then.", ok: "Abort" }, send);
}

byId("battle-buttons").addEventListener("click", ({ target }) => {
  const button = target.closest("button");
  if (button?.getAttribute("aria-disabled") === "false") order(button.dataset.order);
});

/** A form's submit does `send`, then `then`. */
function onSubmit(id, send, then) {
  byId(id).addEventListener("submit", (event) => {
    event.preventDefault();
    act(send, then);
  });
}

onSubmit(
  "message-form",
  () => api.showMessage(byId("message-text").value.trim()),
  () => byId("message-form").reset(),
);
onSubmit("rules-form", () => api.setRules(rules.changed), () => dialogs.toast("The rules are saved."));
onSubmit("words-form", () => api.names({ words: words.words }), () => dialogs.toast("The words are saved."));
byId("ban-form").addEventListener("submit", (event) => {
  event.preventDefault();
  on.ban(byId("ban-name").value.trim().normalize("NFC"), () => byId("ban-form").reset());
});
byId("message-clear").addEventListener("click", () => {
  byId("message-text").focus(); // the button goes
  act(() => api.showMessage(""));
});
byId("problem-close").addEventListener("click", () => view.showProblem(""));
byId("sign-out").addEventListener("click", async () => {
  await api.leave().catch(() => null);
  location.replace("/operator");
});
addEventListener("pageshow", (event) => event.persisted && location.reload());

const tick = () => poll.tick(document.hidden);
document.addEventListener("visibilitychange", tick);
setInterval(tick, INTERVAL / 4);
tick();
