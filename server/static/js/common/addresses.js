// Where the game's other programs are: at ports of the host that this page came from, or, behind the front, below the
// page's own address.

const PATHS = { rosbridge: "rosbridge", relay: "camera" };

const content = (name) => document.querySelector(`meta[name=${name}]`)?.content;

/** Of a WebSocket. @param {"rosbridge"|"relay"} program */
export function socketAddress(program) {
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  return content("front") ? `${scheme}//${location.host}/${PATHS[program]}` : `${scheme}//${location.hostname}:${content(`${program}-port`)}/`;
}
