// Call a Modbus library of Node.js: `modbus_calls.js modbus-serial|jsmodbus tcp|rtu AIR IO`, as modbus_calls.py does.
"use strict";
const net = require("net");

const SENSOR = { tcp: 1, rtu: 7 };
const LINES = { air: { baudRate: 19200 }, io: { baudRate: 115200 } };

// A pseudo-terminal has no parity: the lines are opened without.
async function modbusSerial(link, where, which) {
  const Modbus = require("modbus-serial");
  const client = new Modbus();
  client.setTimeout(5000);
  if (link === "tcp") await client.connectTCP("127.0.0.1", { port: Number(where) });
  else await client.connectRTUBuffered(where, LINES[which]);
  client.setID(which === "air" ? SENSOR[link] : 1);
  return {
    holding: async (a, n) => (await client.readHoldingRegisters(a, n)).data,
    input: async (a, n) => (await client.readInputRegisters(a, n)).data,
    coils: async (a, n) => (await client.readCoils(a, n)).data.slice(0, n),
    discrete: async (a, n) => (await client.readDiscreteInputs(a, n)).data.slice(0, n),
    writeRegister: (a, v) => client.writeRegister(a, v),
    writeRegisters: (a, v) => client.writeRegisters(a, v),
    writeCoil: (a, v) => client.writeCoil(a, v),
    writeCoils: (a, v) => client.writeCoils(a, v),
    complaint: (error) => String(error.message),
  };
}

async function jsModbus(link, where, which) {
  const Modbus = require("jsmodbus");
  const unit = which === "air" ? SENSOR[link] : 1;
  let client;
  if (link === "tcp") {
    const socket = new net.Socket();
    client = new Modbus.client.TCP(socket, unit, 5000);
    await new Promise((resolve) => socket.connect(Number(where), "127.0.0.1", resolve));
  } else {
    const { SerialPort } = require("serialport");
    const port = new SerialPort({ path: where, ...LINES[which] });
    client = new Modbus.client.RTU(port, unit, 5000);
    await new Promise((resolve) => port.on("open", resolve));
  }
  const values = (answer) => answer.response.body.valuesAsArray;
  return {
    holding: async (a, n) => values(await client.readHoldingRegisters(a, n)),
    input: async (a, n) => values(await client.readInputRegisters(a, n)),
    coils: async (a, n) => values(await client.readCoils(a, n)).slice(0, n),
    discrete: async (a, n) => values(await client.readDiscreteInputs(a, n)).slice(0, n),
    writeRegister: (a, v) => client.writeSingleRegister(a, v),
    writeRegisters: (a, v) => client.writeMultipleRegisters(a, v),
    writeCoil: (a, v) => client.writeSingleCoil(a, v),
    writeCoils: (a, v) => client.writeMultipleCoils(a, v),
    complaint: (error) => String(error.response ? error.response.body.code : error.message),
  };
}

async function sensor(calls) {
  const said = {
    holding: await calls.holding(0, 4),
    input: await calls.input(0, 4),
    integers: await calls.holding(256, 2),
    status: await calls.holding(512, 2),
    refused: await calls.holding(20000, 1).then(String, calls.complaint),
  };
  await calls.writeRegister(770, 0x1234);
  said.written = await calls.holding(770, 1);
  await calls.writeRegisters(770, [0, 0x447d]);
  said.both_written = await calls.holding(770, 2);
  return said;
}

async function block(calls) {
  await calls.writeCoils(4, [false, false, false]);
  await calls.writeCoil(4, true);
  const one = (await calls.coils(4, 3)).map(Number);
  await calls.writeCoils(4, [true, false, true]);
  const together = (await calls.coils(4, 3)).map(Number);
  return { one, together, inputs: (await calls.discrete(0, 3)).map(Number) };
}

async function main([library, link, air, io]) {
  const open = library === "jsmodbus" ? jsModbus : modbusSerial;
  const said = { ...(await sensor(await open(link, air, "air"))), ...(await block(await open(link, io, "io"))) };
  console.log("\n" + JSON.stringify(said));
  process.exit(0);
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
