// Who plays, for the arena's own page: from the game's rosbridge, where every guest may follow /game_status.

const TOPIC = "/game_status";
const RETRY = { first: 250, most: 15_000 }; // ms; it doubles while nobody answers
const SILENCE = 4000; // ms; rosbridge sends the state twice a second
const PHASES = ["stopped", "countdown", "playing"];

/**
 * What a laser_bot_battle/GameStatus says about the players, as readPlayers() has it.
 * @returns {import("./players.js").Players}
 */
export function playersOf(status) {
  const playing = status.game === PHASES.indexOf("playing");
  return {
    me: null,
    phase: PHASES[status.game] ?? "",
    effects: "auto",
    scale: 1,
    labels: {},
    players: status.users.map(({ name, robot, life, ready }) => ({
      name, robot, life, ready, out: playing && ready && life === 0, avatar: null, colour: null,
    })),
  };
}

/** Follows the game for ever. */
export class Game {
  #url;
  #receive;
  #wait = RETRY.first;

  /** `receive(players)` gets the players at every news, null when there is no game to hear. */
  constructor(url, receive) {
    this.#url = url;
    this.#receive = receive;
  }

  open() {
    const socket = new WebSocket(this.#url);
    let silence;
    const giveUp = () => {
      clearTimeout(silence);
      socket.onmessage = socket.onclose = null;
      socket.close();
      this.#receive(null);
      setTimeout(() => this.open(), this.#wait);
      this.#wait = Math.min(RETRY.most, 2 * this.#wait);
    };
    const listen = () => {
      clearTimeout(silence);
      silence = setTimeout(giveUp, SILENCE);
    };
    socket.onopen = () => socket.send(JSON.stringify({ op: "subscribe", topic: TOPIC, type: "laser_bot_battle/GameStatus" }));
    socket.onmessage = ({ data }) => {
      const message = JSON.parse(data);
      if (message.op !== "publish" || message.topic !== TOPIC) return;
      listen();
      this.#wait = RETRY.first;
      this.#receive(playersOf(message.msg));
    };
    socket.onclose = giveUp;
    listen();
  }
}
