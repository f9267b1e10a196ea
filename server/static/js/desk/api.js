// The HTTP rim of the operator's desk: JSON out, JSON in.

import { t } from "../common/words.js";

const TIMEOUT = 4000; // ms

/** What the server refused; `status` is HTTP's, the message says what to do, in `lang` if that is not the page's. */
export class Refusal extends Error {
  constructor(status, message, lang = "") {
    super(message);
    this.status = status;
    this.lang = lang;
  }
}

async function call(method, path, body) {
  const response = await fetch(`/operator/api/${path}`, {
    method,
    cache: "no-store",
    ...(body && { headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) }),
    signal: AbortSignal.timeout(TIMEOUT),
  });
  const text = await response.text();
  if (response.ok) return text ? JSON.parse(text) : {};
  const error = errorIn(text);
  if (error) throw new Refusal(response.status, error, "en");
  throw new Refusal(response.status, t("desk.http", { status: String(response.status) }));
}

function errorIn(text) {
  try {
    return JSON.parse(text).error;
  } catch {
    return undefined; // the page of a proxy
  }
}

// Each rejects: with a Refusal, or with another error when the server does not answer in time.

export const state = () => call("GET", "state");
export const drive = () => call("GET", "drive");
export const camera = () => call("GET", "camera");
export const journal = (host, only) => call("GET", `journal?${new URLSearchParams({ host, only })}`);
export const battle = (order) => call("POST", "battle", order);
export const signOut = (name) => call("POST", `players/${encodeURIComponent(name)}/sign_out`, {});
export const names = (change) => call("POST", "names", change);
export const setService = (id, inService) => call("POST", `robots/${id}`, { in_service: inService });
export const giveToBot = (id, level) => call("POST", `robots/${id}`, { bot: level });
export const identify = (id) => call("POST", `robots/${id}/identify`, {});
export const setRules = (values) => call("PUT", "rules", values);
export const presets = (change) => call("POST", "presets", change);
export const openVote = (choices, seconds) => call("POST", "vote", { choices, ...(choices.length && { seconds }) });
export const tournament = (order) => call("POST", "tournament", order);
export const floor = () => call("GET", "floor");
export const checkFloor = (floor) => call("POST", "floor/check", { floor });
export const saveFloor = (floor, version) => call("PUT", "floor", { floor, version });
export const showMessage = (text) => call("POST", "message", { text });

/** Sign this browser out of the desk. */
export const leave = () => fetch("/operator/logout", { method: "POST", signal: AbortSignal.timeout(TIMEOUT) });
