// SPDX-License-Identifier: MIT
// thermorig-avr IMAGE.hex: runs the servo firmware's AVR image in simavr, in lock step with thermorig.
// This source is MIT; the executable links libsimavr, so as a whole it is distributed under the GPL,
// version 3. thermorig itself never links it: they talk through pipes
// (thermorig/simulated_ports/lock_step.h).
#include <simavr/avr_ioport.h>
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

struct Machine {
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
  const RunReply head{machine.sent.size(), machine.pulses.size()};
  if (std::fwrite(&head, sizeof head, 1, to) != 1) std::exit(0);
  write_items(to, machine.sent);
  write_items(to, machine.pulses);
  std::fflush(to);
  machine.sent.clear();
  machine.pulses.clear();
}

bool read_request(Machine& machine, RunRequest& request) {
  if (std::fread(&request, sizeof request, 1, stdin) != 1) return false;
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
