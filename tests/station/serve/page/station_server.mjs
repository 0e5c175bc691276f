// A `threadstation serve` of its own, on a workspace of its own.
import {spawn} from "node:child_process";

// Resolves as soon as it has said its address; `ended` is the promise of its exit status.
export function startServer(program, rig, workspace) {
  const server = spawn(program, ["serve", "--rig", rig, "--workspace", workspace, "--port", "0"],
                       {stdio: ["ignore", "pipe", "inherit"]});
  const ended = new Promise(resolve => server.on("exit", resolve));
  return new Promise((resolve, reject) => {
    let said = "";
    server.stdout.on("data", part => {
      said += part;
      if (said.includes("\n")) resolve({address: said.trim(), ended, stop: () => server.kill("SIGINT")});
    });
    ended.then(status => reject(new Error(`the server ended with ${status} before it said its address`)));
  });
}
