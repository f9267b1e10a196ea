// Uses an open rosbridge with roslib, as a lab does: node roslib_lab.mjs LIBRARY PORT. Prints {"name": value} per step.
const [library, port] = process.argv.slice(2);
const imported = await import(library);
const ROSLIB = imported.default ?? imported;

const tell = (name, value) => console.log(JSON.stringify({ [name]: value }));
const ros = new ROSLIB.Ros({});
ros.on("error", (error) => tell("error", String(error)));
const connected = new Promise((done) => ros.on("connection", done));
ros.connect(`ws://127.0.0.1:${port}`);
await connected;

const topic = (name, messageType, options = {}) => new ROSLIB.Topic({ ros, name, messageType, ...options });
const service = (name, serviceType) => new ROSLIB.Service({ ros, name, serviceType });
const next = (subscribed, wanted = () => true) =>
  new Promise((done) => {
    const hear = (message) => wanted(message) && (subscribed.unsubscribe(hear), done(message));
    subscribed.subscribe(hear);
  });
const call = (name, type, request) =>
  new Promise((done) => service(name, type).callService(request, done, (error) => done({ error })));
const asked = (method, ...given) => new Promise((done) => ros[method](...given, done, (error) => done({ error })));

// the first words are said before any connection between ROS nodes can be there
const say = topic("/lab/say", "std_msgs/String");
const echo = next(topic("/lab/echo", "std_msgs/String"), (message) => message.data.includes(library + " 0"));
for (let number = 0; number < 20; number += 1) say.publish({ data: `${library} ${number}` });
say.publish({ data: "end" });
tell("said", JSON.parse((await echo).data).length);
for (const compression of ["none", "png", "cbor"])
  tell(compression, Array.from((await next(topic("/lab/numbers", "std_msgs/Float32MultiArray", { compression }))).data));

tell("calls", await call("/lab/set_bool", "std_srvs/SetBool", { data: true }));
tell("failure", (await call("/lab/set_bool", "std_srvs/SetBool", { data: false })).error);
const mine = service("/client/set_bool", "std_srvs/SetBool");
mine.advertise((request, response) => {
  response.success = request.data;
  response.message = "from the page";
  return true;
});
tell("serves", await call("/lab/ask", "std_srvs/Trigger", {}));
mine.unadvertise();

const param = new ROSLIB.Param({ ros, name: `/lab/${library}` });
await new Promise((done) => param.set({ speeds: [1, 2.5], name: "zwölf" }, done));
tell("param", await new Promise((done) => param.get(done)));
await new Promise((done) => param.delete(done));
tell("param is left", (await asked("getParams")).includes(param.name));
tell("type", await asked("getTopicType", "/lab/say"));
tell("node", (await asked("getNodes")).includes("/lab"));

const run = (client, goalMessage, heard) =>
  new Promise((done) => {
    const goal = new ROSLIB.Goal({ actionClient: client, goalMessage });
    const feedback = [];
    goal.on("feedback", (message) => {
      feedback.push(message.feedback);
      heard(goal);
    });
    goal.on("result", (result) => done([feedback, goal.status.status, result.result]));
    goal.send();
  });
const counter = new ROSLIB.ActionClient({ ros, serverName: "/lab/action", actionName: "actionlib/TestAction" });
tell("action", await run(counter, { goal: 3 }, () => {}));
tell("cancelled", (await run(counter, { goal: 200 }, (goal) => goal.cancel()))[1]);

const server = new ROSLIB.SimpleActionServer({ ros, serverName: "/client/action", actionName: "actionlib/TestAction" });
server.on("goal", async (goal) => {
  // actionlib's client takes no feedback before its send_goal() has returned
  const repeated = setInterval(() => server.sendFeedback({ feedback: 1 }), 100);
  await call("/lab/acted", "std_srvs/Trigger", {});
  clearInterval(repeated);
  server.setSucceeded({ result: goal.goal });
});
tell("acts", JSON.parse((await call("/lab/act", "std_srvs/Trigger", {})).message));

if (ROSLIB.TFClient) {
  const transforms = new ROSLIB.TFClient({ ros, fixedFrame: "arena", rate: 10 });
  tell("tf", (await new Promise((done) => transforms.subscribe("robot", done))).translation.x);
}
tell("tf topic", (await next(topic("/tf", "tf2_msgs/TFMessage"))).transforms[0].child_frame_id);
ros.close();
process.exit(0); // its action server would publish for ever
