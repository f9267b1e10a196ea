// A player with roslib: node roslib_player.mjs URL NAME SESSION ROBOT. Commands come as lines of JSON, /game_status goes so.
import { createInterface } from "node:readline";
import * as ROSLIB from "roslib";

const [url, name, session, robot] = process.argv.slice(2);
const ros = new ROSLIB.Ros();
ros.on("error", (error) => console.error(String(error)));
await ros.connect(url);
ros.authenticate(session, name, "", "", 0, "", 0);

const topic = (of, messageType) => new ROSLIB.Topic({ ros, name: of, messageType });
topic("/game_status", "laser_bot_battle/GameStatus").subscribe((status) => console.log(JSON.stringify(status)));
const command = topic(`/Robot${robot}/command`, "laser_bot_battle/Robot_msg");
for await (const line of createInterface({ input: process.stdin })) command.publish(JSON.parse(line));
ros.close();
