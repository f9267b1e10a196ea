// Reads a JSON list of objects; prints what the schemas of their custom resource definitions say of each: a list of lists.
// A validator looks at every field that its schema has, and at no other.

const PACKAGES = {
  "argoproj.io": "argo-cd",
  "gateway.networking.k8s.io": "gateway-api",
  "cert-manager.io": "cert-manager",
  "monitoring.coreos.com": "prometheus-operator",
};

function watched(value, path, unseen) {
  if (typeof value !== "object" || value === null) return value;
  const inside = Array.isArray(value) ? value.map((each, at) => watched(each, `${path}[${at}]`, unseen)) : {};
  if (Array.isArray(value)) return inside;
  for (const [key, each] of Object.entries(value)) {
    const name = `${path}.${key}`;
    unseen.add(name);
    inside[key] = watched(each, name, unseen);
  }
  return new Proxy(inside, {
    get(target, key) {
      unseen.delete(`${path}.${String(key)}`);
      return target[key];
    },
  });
}

async function problems(object) {
  const [group, version] = object.apiVersion.split("/");
  const name = group.endsWith(".toolkit.fluxcd.io") ? "flux-cd" : PACKAGES[group];
  const models = await import(`@kubernetes-models/${name}/${group}/${version}`);
  const unseen = new Set();
  const model = new models[object.kind](object);
  model.spec = watched(object.spec, "spec", unseen);
  try {
    model.validate();
  } catch (error) {
    return [error.message];
  }
  return [...unseen].map((name) => `${name} is no field`);
}

let text = "";
for await (const chunk of process.stdin) text += chunk;
console.log(JSON.stringify(await Promise.all(JSON.parse(text).map(problems))));
