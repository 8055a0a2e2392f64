// SPDX-License-Identifier: MIT
// thermorig-avr IMAGE.hex: runs the servo firmware's AVR image in simavr, in lock step with thermorig.
// This source is MIT; the executable links libsimavr, so as a whole it is distributed under the GPL,
// version 3. thermorig itself never links it: they talk through pipes
// (thermorig/simulated_ports/lock_step.h).
#include <simavr/avr_ioport.h>
#include <simavr/avr_twi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_hex.h>
#include <simavr/sim_time.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <vector>

#include "thermorig/simulation/simulated_ports/lock_step.h"

namespace {

using namespace thermorig::lock_step;

constexpr std::int64_t cycles_per_us = 16;
// simavr 1.6 counts 11 bits a byte (it always adds a parity bit), and delivers a byte so long after it is put
// in. It is put in that much early, so that it arrives when it ought to.
constexpr std::int64_t uart_cycles = 11 * 64;

[[noreturn]] void fail(const char* message) {
  std::fprintf(stderr, "thermorig-avr: %s\n", message);
  std::exit(1);
}

constexpr std::uint8_t sensor_address = 0x36;

/// A slave on the TWI: simavr hands it the conditions and bytes of the bus as messages, and takes its
/// acknowledgements and bytes in the same way.
struct Slave {
  Sensor registers;
  avr_irq_t* irqs = nullptr;  // TWI_IRQ_INPUT: to the master; TWI_IRQ_OUTPUT: from it
  std::uint8_t selected = 0;  // the address byte that it answered; 0: none
  bool has_pointer = false;   // the first byte that is written is the register's address
  std::uint8_t pointer = 0;
  std::vector<RegisterByte> writes;
};

struct Machine {
  Slave slave;
  avr_t* avr = nullptr;
  avr_irq_t* uart_input = nullptr;
  std::deque<TimedByte> waiting;
  std::vector<TimedByte> sent;
  std::vector<TimedPulse> pulses;
  std::int64_t rise_cycle = -1;  // of the pulse that is high
};

std::int64_t cycle_of(const Machine& machine) {
  return static_cast<std::int64_t>(machine.avr->cycle);
}

void on_sent(avr_irq_t*, std::uint32_t value, void* param) {
  auto& machine = *static_cast<Machine*>(param);
  machine.sent.push_back({cycle_of(machine) / cycles_per_us, value & 0xFFU});
}

void on_servo_pin(avr_irq_t*, std::uint32_t value, void* param) {
  auto& machine = *static_cast<Machine*>(param);
  const bool high = (value & 1U) != 0U;
  if (high && machine.rise_cycle < 0) machine.rise_cycle = cycle_of(machine);
  if (high || machine.rise_cycle < 0) return;
  const double width_us = static_cast<double>(cycle_of(machine) - machine.rise_cycle) / cycles_per_us;
  machine.pulses.push_back({machine.rise_cycle / cycles_per_us, width_us});
  machine.rise_cycle = -1;
}

avr_cycle_count_t put_in(avr_t*, avr_cycle_count_t when, void* param) {
  auto& machine = *static_cast<Machine*>(param);
  avr_raise_irq(machine.uart_input, static_cast<std::uint32_t>(machine.waiting.front().value));
  machine.waiting.pop_front();
  if (machine.waiting.empty()) return 0;
  const std::int64_t next = machine.waiting.front().time_us * cycles_per_us - uart_cycles;
  const auto now = static_cast<std::int64_t>(when);
  return static_cast<avr_cycle_count_t>(next > now ? next : now + 1);
}

avr_cycle_count_t wake(avr_t*, avr_cycle_count_t, void*) {
  return 0;
}

/// Called for the time that the processor sleeps, to which simavr 1.6 then adds a cycle of its own: without
/// it an edge in that time has its exact cycle.
void do_not_wait(avr_t* avr, avr_cycle_count_t cycles) {
  if (cycles > 0) --avr->cycle;
}

/// simavr reports every section that it loads; that would stand in the middle of somebody's status lines.
void stay_quiet(avr_t*, int, const char*, va_list) {}

void connect_uart(Machine& machine) {
  std::uint32_t flags = 0;  // neither print what is sent nor sleep when it is polled
  avr_ioctl(machine.avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  machine.uart_input = avr_io_getirq(machine.avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  avr_irq_register_notify(avr_io_getirq(machine.avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_sent,
                          &machine);
}

std::uint8_t register_of(const Sensor& sensor, std::uint8_t address) {
  if (sensor.bus == 2) return 0xFF;
  if (address == 0x0B) return sensor.status;
  if (address == 0x0C || address == 0x0E) return static_cast<std::uint8_t>(sensor.raw >> 8U);
  if (address == 0x0D || address == 0x0F) return static_cast<std::uint8_t>(sensor.raw & 0xFFU);
  return address == 0x1A ? sensor.gain : 0;
}

void answer_bus(Slave& slave, std::uint8_t condition, std::uint8_t data) {
  avr_raise_irq(slave.irqs + TWI_IRQ_INPUT, avr_twi_irq_msg(condition, slave.selected, data));
}

void on_bus(avr_irq_t*, std::uint32_t value, void* param) {
  auto& slave = *static_cast<Slave*>(param);
  avr_twi_msg_irq_t message;
  message.u.v = value;
  const auto& bus = message.u.twi;
  if ((bus.msg & TWI_COND_STOP) != 0) slave.selected = 0;
  if ((bus.msg & TWI_COND_START) != 0) {
    slave.selected = 0;
    const bool answers = slave.registers.is_there != 0 && slave.registers.bus != 1;
    if (answers && (bus.addr >> 1U) == sensor_address) {
      slave.selected = bus.addr;
      slave.has_pointer = false;
      answer_bus(slave, TWI_COND_ACK, 1);
    }
  }
  if (slave.selected == 0) return;
  if ((bus.msg & TWI_COND_WRITE) != 0) {
    answer_bus(slave, TWI_COND_ACK, 1);
    if (slave.has_pointer)
      slave.writes.push_back({slave.pointer++, static_cast<std::uint8_t>(bus.data)});
    else
      slave.pointer = static_cast<std::uint8_t>(bus.data);
    slave.has_pointer = true;
  }
  if ((bus.msg & TWI_COND_READ) != 0)
    answer_bus(slave, TWI_COND_READ, register_of(slave.registers, slave.pointer++));
}

/// Of the two interrupts of a part on the bus, the first leads to the master (simavr/avr_twi.h).
void connect_bus(Machine& machine) {
  static const char* names[2] = {"8>sensor.out", "32<sensor.in"};
  Slave& slave = machine.slave;
  slave.irqs = avr_alloc_irq(&machine.avr->irq_pool, 0, 2, names);
  avr_irq_register_notify(slave.irqs + TWI_IRQ_OUTPUT, on_bus, &slave);
  avr_connect_irq(slave.irqs + TWI_IRQ_INPUT,
                  avr_io_getirq(machine.avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_INPUT));
  avr_connect_irq(avr_io_getirq(machine.avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_OUTPUT),
                  slave.irqs + TWI_IRQ_OUTPUT);
}

void load(Machine& machine, const char* path) {
  std::uint32_t size = 0, begin = 0;
  const std::unique_ptr<std::uint8_t, decltype(&std::free)> image(read_ihex_file(path, &size, &begin),
                                                                  std::free);
  if (image == nullptr) fail("cannot read the image");
  machine.avr = avr_make_mcu_by_name("atmega328p");
  if (machine.avr == nullptr) fail("simavr does not know the ATmega328P");
  avr_init(machine.avr);
  machine.avr->log = LOG_NONE;
  machine.avr->frequency = 1'000'000 * cycles_per_us;
  machine.avr->sleep = do_not_wait;
  avr_loadcode(machine.avr, image.get(), size, begin);
  connect_uart(machine);
  connect_bus(machine);
  avr_irq_register_notify(avr_io_getirq(machine.avr, AVR_IOCTL_IOPORT_GETIRQ('B'), 2), on_servo_pin,
                          &machine);
}

void schedule(Machine& machine, std::int64_t cycle, avr_cycle_timer_t what) {
  const std::int64_t wait = cycle - cycle_of(machine);
  avr_cycle_timer_register(machine.avr, static_cast<avr_cycle_count_t>(wait > 1 ? wait : 1), what, &machine);
}

void run_until(Machine& machine, std::int64_t until_us) {
  if (!machine.waiting.empty())
    schedule(machine, machine.waiting.front().time_us * cycles_per_us - uart_cycles, put_in);
  schedule(machine, until_us * cycles_per_us, wake);
  while (cycle_of(machine) < until_us * cycles_per_us) {
    const int state = avr_run(machine.avr);
    if (state == cpu_Crashed || state == cpu_Done) fail("the image crashed");
  }
}

template <class Item>
void write_items(std::FILE* to, const std::vector<Item>& items) {
  if (items.empty()) return;
  if (std::fwrite(items.data(), sizeof(Item), items.size(), to) != items.size()) std::exit(0);
}

void reply(Machine& machine, std::FILE* to) {
  const RunReply head{machine.sent.size(), machine.pulses.size(), machine.slave.writes.size()};
  if (std::fwrite(&head, sizeof head, 1, to) != 1) std::exit(0);
  write_items(to, machine.sent);
  write_items(to, machine.pulses);
  write_items(to, machine.slave.writes);
  std::fflush(to);
  machine.sent.clear();
  machine.pulses.clear();
  machine.slave.writes.clear();
}

bool read_request(Machine& machine, RunRequest& request) {
  if (std::fread(&request, sizeof request, 1, stdin) != 1) return false;
  machine.slave.registers = request.sensor;
  for (std::uint64_t i = 0; i < request.bytes; ++i) {
    TimedByte byte;
    if (std::fread(&byte, sizeof byte, 1, stdin) != 1) return false;
    machine.waiting.push_back(byte);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) fail("usage: thermorig-avr IMAGE.hex");
  std::FILE* replies = fdopen(dup(STDOUT_FILENO), "wb");
  if (replies == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr)
    fail("cannot set up its output");
  avr_global_logger_set(stay_quiet);
  Machine machine;
  load(machine, argv[1]);
  RunRequest request;
  while (read_request(machine, request)) {
    run_until(machine, request.until_us);
    reply(machine, replies);
  }
  return 0;
}
