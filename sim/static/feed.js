// The view's WebSocket, opened again for ever.

const RETRY = 250; // ms
const SILENCE = 3000; // ms without a state: a half-open connection

export class Feed {
  #url;
  #receive;
  #show;
  #socket = null;
  #word = "watch";

  /** `receive(message)` gets every JSON message, `show(state)` one of "connecting", "live", "lost". */
  constructor(url, receive, show) {
    this.#url = url;
    this.#receive = receive;
    this.#show = show;
  }

  /** Tell the arena whether somebody here drives: then all states come, however many watch. */
  set drives(drives) {
    const word = drives ? "drive" : "watch";
    if (word === this.#word) return;
    this.#word = word;
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(word);
  }

  open() {
    const socket = new WebSocket(this.#url);
    this.#socket = socket;
    let silence;
    const listen = () => {
      clearTimeout(silence);
      silence = setTimeout(giveUp, SILENCE);
    };
    const giveUp = () => {
      clearTimeout(silence);
      socket.onmessage = socket.onclose = null;
      socket.close();
      this.#show("lost");
      setTimeout(() => this.open(), RETRY);
    };
    socket.onopen = () => socket.send(this.#word);
    socket.onmessage = (event) => {
      listen();
      this.#show("live");
      this.#receive(JSON.parse(event.data));
    };
    socket.onclose = giveUp;
    listen();
  }
}
