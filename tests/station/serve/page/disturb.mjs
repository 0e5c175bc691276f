// Clients that a station should not notice: rubbish, requests that never end, a thousand connections.
import {connect} from "node:net";

// Opens them all at once and keeps them; resolves to a function that closes them.
export async function disturb(address, connections = 1000) {
  const {hostname, port} = new URL(address);
  const sockets = [];
  const openings = Array.from({length: connections}, (unused, i) => new Promise(resolve => {
    const socket = connect(Number(port), hostname);
    sockets.push(socket);
    socket.on("error", resolve);
    socket.on("connect", () => {
      socket.write(i % 3 === 0 ? Buffer.from([0x16, 0x03, 0x01, 0xff, 0x0d, 0x0a, 0x0d, 0x0a])
        : i % 3 === 1 ? "GET /api/state HTTP/1.1\r\nHost: 127" : "POST /api/stop HTTP/1.1\r\nHost: elsewhere\r\n\r\n");
      resolve();
    });
  }));
  await Promise.all(openings);
  return () => sockets.forEach(socket => socket.destroy());
}
