// Uses rosbridge with roslib as a page does: node roslib_client.mjs PORT. Prints {"name": value} per step.
import * as ROSLIB from "roslib";

const tell = (name, value) => console.log(JSON.stringify({ [name]: value }));
const ros = new ROSLIB.Ros();
ros.on("error", (error) => tell("error", String(error)));
await ros.connect(`ws://127.0.0.1:${process.argv[2]}`);

const topic = (name, messageType, options = {}) => new ROSLIB.Topic({ ros, name, messageType, ...options });
const next = (subscribed, wanted = () => true) =>
  new Promise((done) => subscribed.subscribe((message) => wanted(message) && (subscribed.unsubscribe(), done(message))));
const call = (name, request) =>
  new Promise((done) =>
    new ROSLIB.Service({ ros, name, serviceType: "laser_bot_battle/AddNewRobot" })
      .callService(request, (response) => done({ response }), (error) => done({ error })));

tell("guest watches", (await next(topic("/game_status", "laser_bot_battle/GameStatus"))).game);
tell("guest calls", await call("/add_new_robot", {}));

ros.authenticate("the operators' token", "operator", "", "", 0, "", 0);
tell("operator calls", await call("/add_new_robot", {}));
tell("failure", await call("/fails", {}));

const chat = topic("/roslib_chat", "std_msgs/String", { throttle_rate: 1, queue_length: 5, latch: true });
chat.publish({ data: "grüß Gott" });
tell("operator hears", (await next(chat, (message) => message.data.length > 0)).data);

const command = topic("/Robot50/command", "laser_bot_battle/Robot_msg");
const hearing = topic("/Robot50/command", "laser_bot_battle/Robot_msg");
const driving = setInterval(() => command.publish({ linear_x: 1, angular_z: -1, shoot: false }), 25);
tell("robot hears", await next(hearing, (message) => message.linear_x === 1));
clearInterval(driving);
command.unadvertise();
ros.close();
