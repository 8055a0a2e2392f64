// SPDX-License-Identifier: MIT
#include "timing_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

namespace thermorig::bench {
namespace {

std::string limit_text(const Figure& figure) {
  if (figure.at_most) return fmt::format("<= {:g}", *figure.at_most);
  if (figure.at_least) return fmt::format(">= {:g}", *figure.at_least);
  return "";
}

std::string verdict(const Figure& figure) {
  if (!has_limit(figure)) return "";
  return is_met(figure) ? "met" : "NOT MET";
}

std::string value_text(const Figure& figure) {
  return figure.value ? fmt::format("{:.4g}", *figure.value) : "-";
}

std::string json_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.6g}", *value) : "null";
}

}  // namespace

bool has_limit(const Figure& figure) {
  return figure.at_most || figure.at_least;
}

bool is_met(const Figure& figure) {
  if (!figure.value) return false;
  return (!figure.at_most || *figure.value <= *figure.at_most) &&
         (!figure.at_least || *figure.value >= *figure.at_least);
}

void print_text(const std::vector<Figure>& figures) {
  std::string section;
  for (const Figure& figure : figures) {
    if (figure.section != section) {
      section = figure.section;
      fmt::print(
          "\n### {}\n\n| figure | value | unit | must be | | note |\n| --- | ---: | --- | --- | --- | --- "
          "|\n",
          section);
    }
    fmt::print("| {} | {} | {} | {} | {} | {} |\n", figure.text, value_text(figure), figure.unit,
               limit_text(figure), verdict(figure), figure.note);
  }
}

void print_json(const std::vector<Figure>& figures) {
  fmt::print("{{\n");
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Figure& figure = figures[i];
    const std::string met = has_limit(figure) ? (is_met(figure) ? "true" : "false") : "null";
    fmt::print(
        "  \"{}\": {{\"value\": {}, \"unit\": \"{}\", \"at_most\": {}, \"at_least\": {}, \"met\": {}}}{}\n",
        figure.key, json_number(figure.value), figure.unit, json_number(figure.at_most),
        json_number(figure.at_least), met, i + 1 < figures.size() ? "," : "");
  }
  fmt::print("}}\n");
}

double rms(const std::vector<float>& values) {
  double squares = 0.0;
  for (const float value : values) squares += static_cast<double>(value) * static_cast<double>(value);
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

double size_percentile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  const auto smaller = [](float a, float b) { return std::abs(a) < std::abs(b); };
  std::nth_element(values.begin(), values.begin() + at, values.end(), smaller);
  return std::abs(static_cast<double>(values[static_cast<std::size_t>(at)]));
}

void for_each_seed(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto run = [&] {
    try {
      for (std::size_t index = next++; index < count; index = next++) work(index);
    } catch (...) {
      const std::lock_guard lock(failing);
      failure = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) threads.emplace_back(run);
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace thermorig::bench
