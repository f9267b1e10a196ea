// The HTTP rim: forms out, JSON text in.

const TIMEOUT = 4000; // ms

/** What the server answered; `status` is its word (OK, UNAVAILABLE, ...), `body` the raw text. */
async function read(response) {
  const body = await response.text();
  try {
    return { ...JSON.parse(body), body };
  } catch {
    return { status: `HTTP ${response.status}`, body };
  }
}

async function post(route, fields) {
  const response = await fetch(route, {
    method: "POST",
    body: new URLSearchParams(fields),
    signal: AbortSignal.timeout(TIMEOUT),
  });
  return read(response);
}

// Each rejects when the server does not answer in time.

/** With a `robot` of one's choice, or with "" for any; without a free one, the player waits for one: status QUEUED. */
export const signUp = (name, avatar, robot) =>
  post("/signUpUser", { data: name, avatar, ...(robot === "" ? { wait: 1 } : { robot }) });
export const takeRobot = () => post("/takeRobot", {});
export const signOut = (name) => post("/signOutUser", { data: name });
export const setReady = (name, ready) => post("/playerReady", { user: name, ready: ready ? 1 : 0 });
/** A team for the battles to come; 0: the referee deals it. */
export const chooseTeam = (name, team) => post("/chooseTeam", { user: name, team });
export const availableRobots = () => post("/getAvailableRobots", { data: "data" });

/** The state of the battle. A proxy's error page counts as no answer. */
export async function gameStatus() {
  const reply = await post("/updateGameStatus", { data: "data" });
  if (reply.status !== "OK") throw new Error(`/updateGameStatus: ${reply.status}`);
  return reply;
}

/** The state of the battle for who only watches, a laser_bot_battle/GameStatus. It is nobody's sign of life: no cookie goes along. */
export async function watchedStatus() {
  const response = await fetch("/watch.json", { cache: "no-store", credentials: "omit", signal: AbortSignal.timeout(TIMEOUT) });
  if (!response.ok) throw new Error(`/watch.json: ${response.status}`);
  return response.json();
}

/**
 * Whose the session cookie is: {status: "OK", user, robot, ticket}; of somebody who waits for a robot, {status: "QUEUED", user,
 * place, offer, seconds} (see queue.js); or {status: "UNREGISTERED"}.
 */
export async function session() {
  const reply = await read(await fetch("/session", { cache: "no-store", signal: AbortSignal.timeout(TIMEOUT) }));
  if (!["OK", "QUEUED", "UNREGISTERED"].includes(reply.status)) throw new Error(`/session: ${reply.status}`);
  return reply;
}
