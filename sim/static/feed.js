// The view's WebSocket, opened again for ever.

const RETRY = 1000; // ms
const SILENCE = 3000; // ms without a state: a half-open connection

export class Feed {
  /** `receive(message)` gets every JSON message, `show(state)` one of "connecting", "live", "lost". */
  constructor(url, receive, show) {
    this.url = url;
    this.receive = receive;
    this.show = show;
  }

  open() {
    const socket = new WebSocket(this.url);
    let silence;
    const listen = () => {
      clearTimeout(silence);
      silence = setTimeout(giveUp, SILENCE);
    };
    const giveUp = () => {
      clearTimeout(silence);
      socket.onmessage = socket.onclose = null;
      socket.close();
      this.show("lost");
      setTimeout(() => this.open(), RETRY);
    };
    socket.onmessage = (event) => {
      listen();
      this.show("live");
      this.receive(JSON.parse(event.data));
    };
    socket.onclose = giveUp;
    listen();
  }
}
