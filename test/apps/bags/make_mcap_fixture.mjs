// Writes test/corpus/bag/by_mcap_core.mcap, which the readers are tested with: a robot that drives
// along a room, by a writer and a serializer that are not ours. Run it in a folder with
//   npm install @mcap/core @foxglove/rosmsg @foxglove/rosmsg2-serialization \
//       @foxglove/rosmsg-msgs-common lz4js
//   cp .../test/apps/bags/make_mcap_fixture.mjs . && node make_mcap_fixture.mjs by_mcap_core.mcap
import { writeFileSync } from "node:fs";
import { McapWriter, TempBuffer } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import lz4 from "lz4js";

// The definition of a type and of all that it has inside, as ROS 2 puts them into one text.
function definitionOf(type) {
  const texts = [];
  const todo = [type], seen = new Set();
  while (todo.length > 0) {
    const name = todo.shift();
    if (seen.has(name)) continue;
    seen.add(name);
    const { definitions } = ros2humble[name];
    const lines = definitions.map((field) => {
      if (field.isComplex) todo.push(field.type);
      const count = field.isArray ? `[${field.arrayLength ?? ""}]` : "";
      const type = field.type === "time" ? "builtin_interfaces/Time" : field.type;
      return field.isConstant ? "" : `${type}${count} ${field.name}`;
    });
    const heading = texts.length === 0 ? "" : `${"=".repeat(80)}\nMSG: ${name}\n`;
    texts.push(heading + lines.join("\n") + "\n");
  }
  return texts.join("");
}

const file = new TempBuffer();
const mcap = new McapWriter({
  writable: file,
  chunkSize: 1500,
  compressChunk: (data) => ({ compression: "lz4", compressedData: lz4.compress(data) }),
});
await mcap.start({ profile: "ros2", library: "" });

const channels = {};
async function write(topic, type, timeNs, message) {
  if (!channels[topic]) {
    const definition = definitionOf(type);
    const schemaId = await mcap.registerSchema({
      name: type.replace("/", "/msg/"),
      encoding: "ros2msg",
      data: new TextEncoder().encode(definition),
    });
    const id = await mcap.registerChannel({
      schemaId, topic, messageEncoding: "cdr", metadata: new Map([["offered_qos_profiles", ""]]),
    });
    channels[topic] = { id, writer: new MessageWriter(parse(definition, { ros2: true })), sequence: 0 };
  }
  const { id, writer } = channels[topic];
  await mcap.addMessage({
    channelId: id, sequence: channels[topic].sequence++, logTime: timeNs, publishTime: timeNs,
    data: writer.writeMessage(message),
  });
}

const stampAt = (timeNs) => ({
  sec: Number(timeNs / 1000000000n), nanosec: Number(timeNs % 1000000000n),
});
const rotation = { x: 0, y: 0, z: 0, w: 1 };
const start = 1700000000000000000n;
await write("/tf_static", "tf2_msgs/TFMessage", start, { transforms: [{
  header: { stamp: stampAt(0n), frame_id: "base_link" }, child_frame_id: "laser",
  transform: { translation: { x: 0.25, y: 0, z: 0.5 }, rotation },
}] });
for (let i = 0; i < 8; ++i) {
  const time = start + BigInt(i) * 200000000n;
  const x = 0.125 * i;
  const covariance = new Float64Array(36), zero = { x: 0, y: 0, z: 0 };
  await write("/odom", "nav_msgs/Odometry", time, {
    header: { stamp: stampAt(time), frame_id: "odom" }, child_frame_id: "base_link",
    pose: { pose: { position: { x, y: 0, z: 0 }, orientation: rotation }, covariance },
    twist: { twist: { linear: zero, angular: zero }, covariance },
  });
  // A room of 6 m by 4 m, seen over the full circle.
  const ranges = Float32Array.from({ length: 120 }, (_, beam) => {
    const bearing = -Math.PI + (beam * Math.PI) / 60;
    const ahead = (Math.cos(bearing) > 0 ? 4 : -2) - x - 0.25;
    return Math.min(ahead / Math.cos(bearing), 2 / Math.abs(Math.sin(bearing)));
  });
  await write("/scan", "sensor_msgs/LaserScan", time, {
    header: { stamp: stampAt(time), frame_id: "laser" },
    angle_min: -Math.PI, angle_max: Math.PI - Math.PI / 60, angle_increment: Math.PI / 60,
    time_increment: 0, scan_time: 0.2, range_min: 0.125, range_max: 12, ranges, intensities: [],
  });
}
await mcap.end();
writeFileSync(process.argv[2], file.get());
