// SPDX-License-Identifier: MIT
#include "device_layouts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "simulation/gyro.h"
#include "thermorig/core/frame.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/wire/checksums.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::bench {

namespace {

constexpr double rad_s = 180.0 / std::numbers::pi;

std::string text_of(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

void put(std::string& bytes, std::uint64_t number, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(number >> (8 * i));
}

/// The temperatures of a frame, `columns` a line.
std::string pixels(int frame, std::size_t columns, const std::string& between, const std::string& line_end,
                   const char* one = "{:.2f}") {
  std::string text;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
    text += fmt::format(fmt::runtime(one), temperature_c(frame, pixel));
    text += (pixel + 1) % columns == 0 ? line_end : between;
  }
  return text;
}

std::string floats(int frame) {
  std::string bytes;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    put(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(temperature_c(frame, pixel))), 4);
  return bytes;
}

std::string words(int frame, double counts) {
  std::string bytes;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    put(bytes, static_cast<std::uint64_t>(std::lround(counts * temperature_c(frame, pixel))), 2);
  return bytes;
}

DeviceLayout camera(std::string name, std::function<std::string(int)> message, std::string above = "",
                    std::string refusal = "") {
  return {.name = std::move(name),
          .device = Device::camera,
          .message = std::move(message),
          .above = std::move(above),
          .refusal = std::move(refusal),
          .tolerance = 0.051,
          .rate_hz = 8.0};
}

/// A line of a sketch; its three rates are numbers of `unit_dps`, printed as `one` says.
DeviceLayout sketch(const std::string& name, double unit_dps, const char* one,
                    std::function<std::string(const std::array<std::string, 3>&)> line,
                    std::string above = "") {
  const sensors::GyroSketch* const known = sensors::find_gyro_sketch(name);
  DeviceLayout layout{.name = name, .above = std::move(above), .tolerance = 0.51 * unit_dps};
  const std::string printed = one;
  if (printed.find('.') != printed.npos)
    layout.tolerance *= std::pow(10.0, -(printed[printed.find('.') + 1] - '0'));
  layout.message = [=](int i) {
    std::array<std::string, 3> numbers;
    for (std::size_t axis = 0; axis < 3; ++axis)
      numbers[axis] = fmt::format(fmt::runtime(printed), rates_dps(i)[axis] / unit_dps);
    return line(numbers);
  };
  if (known == nullptr) return layout;
  if (known->mark.empty())
    layout.answer = known->columns;
  else
    layout.sketch = name;
  layout.rate_hz = known->rate_hz;
  return layout;
}

DeviceLayout refused(std::string name, std::function<std::string(int)> message, std::string refusal,
                     std::string above = "") {
  return {.name = std::move(name),
          .message = std::move(message),
          .above = std::move(above),
          .refusal = std::move(refusal)};
}

/// As the simulated rig sends it.
DeviceLayout framed(std::string name, const char* protocol, double tolerance,
                    const std::map<std::string, double>& settings = {}) {
  GyroProfile profile;
  profile.protocol = protocol;
  profile.settings = settings;
  return {.name = std::move(name),
          .message =
              [profile](int i) {
                simulation::SimulatedGyroSample sample;
                sample.index = static_cast<std::uint64_t>(i);
                sample.rate_dps = rates_dps(i);
                sample.device_time_us = 10'000LL * i;
                return text_of(simulation::gyro_encoder(profile).bytes(sample, profile));
              },
          .tolerance = tolerance};
}

std::string xsens(const std::string& items) {
  std::string message = "\xFA\xFF\x36";
  put(message, items.size(), 1);
  message += items;
  unsigned sum = 0;
  for (const char c : message) sum += static_cast<std::uint8_t>(c);
  put(message, 0x100U - ((sum - 0xFAU) & 0xFFU), 1);
  return message;
}

std::string big_endian_double(double number) {
  std::string bytes;
  put(bytes, std::bit_cast<std::uint64_t>(number), 8);
  return {bytes.rbegin(), bytes.rend()};
}

std::string hipnuc_counts(int i) {
  std::string payload("\x81\0\0\0", 4);
  put(payload, 2400, 2);
  put(payload, static_cast<std::uint64_t>(10 * i), 4);
  put(payload, 0, 2);
  for (const double rate_dps : rates_dps(i))
    put(payload, static_cast<std::uint64_t>(std::lround(1e3 * rate_dps / rad_s)), 2);
  payload.resize(104);
  std::string header("\x5A\xA5", 2);
  put(header, payload.size(), 2);
  unsigned crc = 0;
  for (const char c : header + payload) {
    crc ^= static_cast<std::uint8_t>(c) << 8U;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 0x8000U) != 0 ? (crc << 1U ^ 0x1021U) & 0xFFFFU : crc << 1U;
  }
  put(header, crc, 2);
  return header + payload;
}

std::string mip(const std::string& fields) {
  std::string packet("\x75\x65\x80", 3);
  put(packet, fields.size(), 1);
  packet += fields;
  unsigned first = 0, second = 0;
  for (const char c : packet) second += first += static_cast<std::uint8_t>(c);
  put(packet, first, 1);
  put(packet, second, 1);
  return packet;
}

std::string msp(int i) {
  std::string body("\x12\x66", 2);
  for (int word = 0; word < 9; ++word) put(body, static_cast<std::uint64_t>(100 * word + i), 2);
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<std::uint8_t>(c);
  put(body, sum, 1);
  return "$M>" + body;
}

std::string with_xor(const std::string& text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<std::uint8_t>(c);
  return fmt::format("${}*{:02X}\r\n", text, sum);
}

using Numbers = std::array<std::string, 3>;

void add_text_gyros(std::vector<DeviceLayout>& all) {
  const std::string line = "\r\n";
  all.push_back(sketch("i2cdevlib-mpu6050", 1.0 / 131.0, "{:.0f}", [=](const Numbers& g) {
    return fmt::format("a/g:\t-104\t52\t16500\t{}{}", fmt::join(g, "\t"), line);
  }));
  all.push_back(sketch("adafruit-mpu6050", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format(
        "Acceleration X: 0.12, Y: -0.30, Z: 9.81 m/s^2\r\nRotation X: {}, Y: {}, Z: {} rad/s\r\nTemperature: "
        "28.41 degC\r\n\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("adafruit-mpu6050-plotter", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format("AccelX:0.12,AccelY:-0.30,AccelZ:9.81, GyroX:{},GyroY:{},GyroZ:{}\r\n", g[0], g[1],
                       g[2]);
  }));
  all.push_back(sketch("adafruit-lsm6ds", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format(
        "\t\tTemperature 25.10 deg C\r\n\t\tAccel X: 0.12 \tY: -0.30 \tZ: 9.81 m/s^2 \r\n\t\tGyro X: {} \tY: "
        "{} "
        "\tZ: {} radians/s \r\n\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("adafruit-unified", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format("25.10,0.12,-0.30,9.81,{}\r\n", fmt::join(g, ","));
  }));
  all.push_back(sketch("adafruit-bno055", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format(
        "Orient:\tx= 359.94 |\ty= -1.56 |\tz= 2.31\r\nGyro:\tx= {} |\ty= {} |\tz= {}\r\nLinear:\tx= 0.01 "
        "|\ty= "
        "0.02 |\tz= -0.03\r\n\r\ntemperature: 28\r\nCalibration: Sys=0 Gyro=3 Accel=0 Mag=0\r\n--\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("adafruit-bno08x", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format("Accelerometer - x: 0.12 y: -0.30 z: 9.81\r\nGyro - x: {} y: {} z: {}\r\n", g[0], g[1],
                       g[2]);
  }));
  all.push_back(sketch(
      "sparkfun-bno080", rad_s, "{:.2f}",
      [=](const Numbers& g) { return fmt::format("{},\r\n", fmt::join(g, ",")); },
      "BNO080 Read Example\r\nGyro enabled\r\nOutput in form x, y, z, in radians per second\r\n"));
  all.push_back(sketch(
      "arduino-imu", 1.0, "{:.2f}",
      [=](const Numbers& g) { return fmt::format("{}\r\n", fmt::join(g, "\t")); },
      "Gyroscope sample rate = 104.00 Hz\r\n\r\nGyroscope in degrees/second\r\nX\tY\tZ\r\n"));
  all.push_back(sketch("sparkfun-icm20948", 1.0, "{:09.2f}", [=](const Numbers& g) {
    return fmt::format(
        "Scaled. Acc (mg) [ -00012.34,  00001.22,  01000.55 ], Gyr (DPS) [ {}, {}, {} ], Mag (uT) [  "
        "00020.10, "
        "-00012.00,  00039.15 ], Tmp (C) [  00025.10 ]\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("sparkfun-icm20948-raw", 1.0 / 131.0, "{:06.0f}", [=](const Numbers& g) {
    return fmt::format(
        "RAW. Acc [ -00123,  00045,  16384 ], Gyr [ {}, {}, {} ], Mag [ 00123, -00045, 00310 ], Tmp [ 01234 "
        "]\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("sparkfun-bmi270", 1.0, "{:.3f}", [=](const Numbers& g) {
    return fmt::format(
        "Acceleration in g's\tX: 0.012\tY: -0.030\tZ: 0.998\tRotation in deg/sec\tX: {}\tY: {}\tZ: {}\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("tockn-mpu6050", 1.0, "{:.2f}", [=](const Numbers& g) {
    return fmt::format(
        "temp : 26.03\r\naccX : 0.01\taccY : -0.02\taccZ : 1.00\r\ngyroX : {}\tgyroY : {}\tgyroZ : {}\r\n"
        "accAngleX : 1.16\taccAngleY : 2.19\r\ngyroAngleX : 41.00\tgyroAngleY : 11.95\tgyroAngleZ : 3.20\r\n"
        "angleX : 0.94\tangleY : 2.16\tangleZ : 92.90\r\n=======\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("mpu6050-light", 1.0, "{:.2f}", [=](const Numbers& g) {
    return fmt::format(
        "TEMPERATURE: 26.03\r\nACCELERO  X: 0.01\tY: -0.02\tZ: 1.00\r\nGYRO      X: {}\tY: {}\tZ: {}\r\nACC "
        "ANGLE "
        "X: 1.16\tY: 2.19\r\nANGLE     X: 0.94\tY: 2.16\tZ: 92.90\r\n",
        g[0], g[1], g[2]);
  }));
  all.push_back(sketch("bolderflight-imu", rad_s, "{:.2f}", [=](const Numbers& g) {
    return fmt::format("1\t0\t0.12\t-0.30\t9.81\t{}\t12.3\t-4.5\t33.1\t25.1\r\n", fmt::join(g, "\t"));
  }));
  all.push_back(sketch("sparkfun-razor-m0", 1.0, "{:.2f}", [=](const Numbers& g) {
    return fmt::format("12345, 0.01, -0.03, 1.00, {}, 12.30, -4.50, 33.10\r\n", fmt::join(g, ", "));
  }));
  all.push_back(sketch("razor-ahrs", 1.0 / 14.375, "{:.2f}", [=](const Numbers& g) {
    return fmt::format("#A-C=2.00,-5.00,256.00\r\n#M-C=12.00,31.00,288.00\r\n#G-C={}\r\n", fmt::join(g, ","));
  }));
  all.push_back(sketch("JSON, a unit in the names", 1.0, "{:.3f}", [=](const Numbers& g) {
    return fmt::format(R"({{"t":12,"gyro_x_dps":{},"gyro_y_dps":{},"gyro_z_dps":{}}})", g[0], g[1], g[2]) +
           "\n";
  }));
  all.push_back(sketch("JSON, an array and its unit", rad_s, "{:.4f}", [=](const Numbers& g) {
    return fmt::format(R"({{"gyro":[{}],"unit":"rad/s"}})", fmt::join(g, ",")) + "\n";
  }));
  DeviceLayout asked = sketch("JSON without a unit, deg/s asked", 1.0, "{:.3f}", [=](const Numbers& g) {
    return fmt::format(R"({{"gx":{},"gy":{},"gz":{}}})", g[0], g[1], g[2]) + "\n";
  });
  asked.answer = TextColumns{};
  all.push_back(asked);
  DeviceLayout summed = sketch("$GYRO with a sum, deg/s asked", 1.0, "{:.3f}", [=](const Numbers& g) {
    return with_xor(fmt::format("GYRO,{}", fmt::join(g, ",")));
  });
  summed.answer = TextColumns{.prefix = "$GYRO,"};
  all.push_back(summed);
}

void add_framed_gyros(std::vector<DeviceLayout>& all) {
  all.push_back(framed("VectorNav VNIMU", "vectornav", 1e-3));
  all.push_back(framed("VectorNav VNYMR", "vectornav", 1e-3, {{"filtered", 1.0}}));
  all.push_back(framed("Xsens MTData2", "xsens", 1e-3));
  all.push_back({.name = "Xsens MTData2, doubles and a counter", .message = [](int i) {
                   std::string items("\x10\x20\x02", 3);
                   put(items, static_cast<std::uint64_t>(i / 256), 1);
                   put(items, static_cast<std::uint64_t>(i % 256), 1);
                   items += std::string("\x80\x23\x18", 3);
                   for (const double rate : rates_dps(i)) items += big_endian_double(rate / rad_s);
                   return xsens(items);
                 }});
  all.push_back(framed("MicroStrain MIP", "mip", 1e-3));
  all.push_back(framed("HiPNUC 91", "hipnuc", 1e-3));
  all.push_back({.name = "HiPNUC 81", .message = hipnuc_counts, .tolerance = 0.03});
  all.push_back(framed("WitMotion", "witmotion", 0.04));
  all.push_back(framed("MAVLink SCALED_IMU", "mavlink", 0.03));
  all.push_back(framed("MAVLink HIGHRES_IMU", "mavlink", 1e-3, {{"message", 105.0}}));
}

void add_refused_gyros(std::vector<DeviceLayout>& all) {
  all.push_back(refused("MSP", msp, "MSP"));
  all.push_back(refused(
      "Xsens without rates", [](int) { return xsens(std::string("\x20\x10\x04\1\2\3\4", 7)); },
      "RateOfTurn"));
  all.push_back(refused(
      "MIP of delta theta", [](int) { return mip(std::string("\x0E\x07\0\0\0\0\0\0\0\0\0\0\0\0", 14)); },
      "field 05"));
  all.push_back(refused(
      "VectorNav of attitude", [](int) { return with_xor("VNYPR,+010.071,+000.278,-002.026"); }, "VNIMU"));
  all.push_back(refused(
      "WitMotion over Bluetooth",
      [](int i) {
        std::string frame("\x55\x61", 2);
        for (int word = 0; word < 9; ++word) put(frame, static_cast<std::uint64_t>(100 * word + i), 2);
        return frame;
      },
      "no check sum"));
  all.push_back(refused(
      "WitMotion over Modbus",
      [](int) { return std::string("\x50\x03\x06\x00\x01\x00\x02\x00\x03\x0C\xE7", 11); }, "Modbus"));
  all.push_back(refused(
      "teapot",
      [](int i) {
        std::string packet("$\x02\x3F\x01\x02\x03\x04\x05\x06\x07\x00", 11);
        put(packet, static_cast<std::uint64_t>(i), 1);
        return packet + "\r\n";
      },
      "quaternion"));
  all.push_back(refused(
      "BNO08x in RVC mode",
      [](int i) {
        std::string body(16, '\0');
        body[0] = static_cast<char>(i);
        unsigned sum = 0;
        for (std::size_t at = 1; at < 13; ++at)
          body[at] = static_cast<char>(7 * i + 11 * static_cast<int>(at));
        for (const char c : body) sum += static_cast<std::uint8_t>(c);
        body += static_cast<char>(sum);
        return "\xAA\xAA" + body;
      },
      "no rates of turn"));
  all.push_back(refused(
      "VectorNav with wrong sums", [](int) { return std::string("$VNIMU,+01.18,-00.24*00\r\n"); },
      "check sums are all wrong"));
  all.push_back(refused(
      "two sensors by turns",
      [](int i) {
        const auto rate = rates_dps(i);
        return fmt::format("imu={} gx={:.2f} gy={:.2f} gz={:.2f} dps\r\n", 1 + i % 2, rate[0], rate[1],
                           rate[2]);
      },
      "several sensors"));
  const auto angles = [&](const char* name, const char* form) {
    all.push_back(refused(
        name,
        [form](int i) {
          const auto angle = rates_dps(i);
          return fmt::format(fmt::runtime(form), angle[0], angle[1], angle[2]);
        },
        "no rates of turn"));
  };
  angles("ypr", "ypr\t{:.2f}\t{:.2f}\t{:.2f}\r\n");
  angles("euler", "euler\t{:.2f}\t{:.2f}\t{:.2f}\r\n");
  angles("quat", "quat\t0.99\t{:.2f}\t{:.2f}\t{:.2f}\r\n");
  angles("#YPR=", "#YPR={:.2f},{:.2f},{:.2f}\r\n");
  angles("Yaw, Pitch, Roll", "Yaw, Pitch, Roll: {:.2f}, {:.2f}, {:.2f}\r\n");
  angles("BNO055 rawdata", "X: {:.4f} Y: {:.4f} Z: {:.4f}\t\tCALIBRATION: Sys=0 Gyro=3 Accel=0 Mag=0\r\n");
}

}  // namespace

std::array<double, 3> rates_dps(int sample) {
  return {3.0 * (sample * 7 % 11) - 15.0, 4.0 * (sample * 5 % 13) - 24.0, 5.0 * (sample * 11 % 37) - 90.0};
}

double temperature_c(int frame, std::size_t pixel) {
  return 20.0 + 0.1 * static_cast<double>((pixel * 7 + static_cast<std::size_t>(frame) * 13) % 97);
}

std::vector<DeviceLayout> camera_layouts() {
  std::vector<DeviceLayout> all;
  const std::string banner =
      "Adafruit MLX90640 Simple Test\r\nFound Adafruit MLX90640\r\nSerial number: 1A2B3C4D5E6F\r\nCurrent "
      "mode: Chess\r\nCurrent resolution: 18 bit\r\nCurrent frame rate: 2 Hz\r\n";
  const std::string line35 = std::string(35, '=') + "\r\n";
  all.push_back(camera(
      "Adafruit simpletest 1.1",
      [=](int i) {
        return line35 + "Ambient temperature = 27.41 degC\r\n\r\n\r\n" +
               pixels(i, 32, ", ", ", \r\n", "{:.1f}");
      },
      banner));
  all.push_back(camera(
      "Adafruit simpletest 1.0",
      [=](int i) { return line35 + "\r\n\r\n" + pixels(i, 32, ", ", ", \r\n", "{:.1f}"); }, banner));
  all.push_back(camera(
      "Adafruit simpletest, a picture of letters",
      [=](int i) {
        std::string text = line35 + "Ambient temperature = 27.41 degC\r\n\r\n\r\n";
        for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
          text += " .-*+x%#X"[(pixel + static_cast<std::size_t>(i)) % 9];
          if (pixel % 32 == 31) text += "\r\n";
        }
        return text;
      },
      banner, "PRINT_TEMPERATURES"));
  all.push_back(camera(
      "CircuitPython simpletest",
      [](int i) { return "Read 2 frames in 1.03 s\n" + pixels(i, 32, ", ", ", \n", "{:.1f}") + "\n"; },
      "MLX addr detected on I2C\n['0x1a2b', '0x3c4d', '0x5e6f']\n"));
  all.push_back(camera("SparkFun Example 2", [](int i) { return pixels(i, 768, ",", ",\r\n"); }));
  all.push_back(camera("SparkFun Example 3", [](int i) {
    return "Read rate: 3.97 Hz\r\nRead plus print rate: 1.80 Hz\r\n" + pixels(i, 768, ",", ",\r\n");
  }));
  all.push_back(camera(
      "SparkFun Example 1, ten pixels",
      [](int i) {
        std::string text;
        for (std::size_t pixel = 0; pixel < 10; ++pixel)
          text += fmt::format("Pixel {}: {:.2f}C\r\n", pixel, temperature_c(i, pixel));
        return text + "\r\n";
      },
      "MLX90640 IR Array Example\r\n", "ten"));
  all.push_back(camera("a count in front", [](int i) {
    return fmt::format("{},", 1000 + 250 * i) + pixels(i, 768, ",", "\r\n");
  }));
  all.push_back(camera(
      "degrees Fahrenheit", [](int i) { return "Temp (F)\r\n" + pixels(i, 768, ",", "\r\n"); }, "",
      "Fahrenheit"));
  all.push_back(camera(
      "half-images",
      [](int i) {
        std::string text;
        for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
          text += (pixel / 32 + pixel) % 2 == 0 ? fmt::format("{:.2f},", temperature_c(i, pixel)) : "0.00,";
        return text + "\r\n";
      },
      "", "half-images"));
  all.push_back(camera("blanks between", [](int i) { return pixels(i, 768, " ", "\r\n"); }));
  all.push_back(camera("commas between", [](int i) { return pixels(i, 768, ",", "\r\n"); }));
  all.push_back(camera(
      "MLX90641, 192 a line",
      [](int i) {
        std::string text;
        for (std::size_t pixel = 0; pixel < 192; ++pixel)
          text += fmt::format("{:.2f},", temperature_c(i, pixel));
        return text + "\r\n";
      },
      "", "192 numbers"));
  all.push_back(camera(
      "JSON lines", [](int i) { return "{\"temperature\":[" + pixels(i, 768, ",", "],\"at\":24.50}\n"); }));
  all.push_back(camera("JSON lines with errors between", [](int i) {
    return std::string(i % 4 == 3 ? "{\"error\":\"Frame Read Failed\"}\n" : "") + "{\"data\":[" +
           pixels(i, 768, ",", "]}\n");
  }));
  all.push_back(
      camera("MicroPython's list", [](int i) { return "[" + pixels(i, 768, ", ", "]\n", "{:.15f}"); }));
  all.push_back(camera(
      "a pixel a line",
      [](int i) {
        std::string text;
        for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
          text += fmt::format("{},{},{},{:.2f}\n", i, pixel / 32, pixel % 32, temperature_c(i, pixel));
        return text;
      },
      "frame,row,col,temp_C\n"));
  all.push_back(camera("AA BB CC DD, floats", [](int i) { return "\xAA\xBB\xCC\xDD" + floats(i); }));
  all.push_back(camera("AA AA, floats", [](int i) { return "\xAA\xAA" + floats(i); }));
  all.push_back(camera("FF FF FF FF, floats", [](int i) { return "\xFF\xFF\xFF\xFF" + floats(i); }));
  all.push_back(camera("BEGIN, floats, END", [](int i) {
    std::string ahead;
    for (const float value : {29.7F, 19.9F, 24.0F}) put(ahead, std::bit_cast<std::uint32_t>(value), 4);
    return "BEGIN" + ahead + floats(i) + "END";
  }));
  all.push_back(camera("floats without a mark", floats, "", "without a mark"));
  all.push_back(camera("CA 01, tenths", [](int i) { return "\xCA\x01" + words(i, 10.0); }));
  all.push_back(camera("00 80, hundredths",
                       [](int i) { return std::string("\x00\x80\x01\x00\x00\x06", 6) + words(i, 100.0); }));
  all.push_back(camera("S, hexadecimal tenths", [](int i) {
    std::string text = "S";
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      text += fmt::format("{:04x}", std::lround(10.0 * temperature_c(i, pixel)));
    return text;
  }));
  all.push_back(camera("GY-MCU90640", [](int i) {
    ThermalFrame frame;
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      frame.temp_c[pixel] = static_cast<float>(temperature_c(i, pixel));
    frame.sensor_temp_c = 30.0F;
    return text_of(wire::camera_frame(frame));
  }));
  all.push_back(camera("mlx-raw, images of an MLX90642", [](int i) {
    std::string text("MXI\x03\x02", 5);
    const auto put_word = [&text](long word) {
      text += static_cast<char>(word >> 8U & 0xFF);
      text += static_cast<char>(word & 0xFF);
    };
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      put_word(std::lround(50.0 * temperature_c(i, pixel)));
    put_word(3000);
    put_word(0);
    put_word(wire::crc16_xmodem(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size())));
    return text;
  }));
  all.push_back(camera(
      "a scaled picture, whole numbers",
      [](int i) {
        std::string text;
        for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
          text += fmt::format("{},", (pixel * 7 + static_cast<std::size_t>(i)) % 256);
        return text + "\r\n";
      },
      "", "without temperatures"));
  return all;
}

std::vector<DeviceLayout> gyro_layouts() {
  std::vector<DeviceLayout> all;
  add_text_gyros(all);
  add_framed_gyros(all);
  add_refused_gyros(all);
  return all;
}

}  // namespace thermorig::bench
