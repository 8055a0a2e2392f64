// SPDX-License-Identifier: MIT
#include "world_knobs.h"

#include <array>

namespace thermorig::simulation {
namespace {

template <auto Part, auto Number>
double& knob_at(World& world) {
  return world.*Part.*Number;
}

template <auto Number>
constexpr auto servo = knob_at<&World::servo, Number>;
template <auto Number>
constexpr auto servo_clock = knob_at<&World::clock, Number>;
template <auto Number>
constexpr auto links = knob_at<&World::links, Number>;
template <auto Number>
constexpr auto gyro = knob_at<&World::gyro, Number>;
template <auto Number>
constexpr auto camera = knob_at<&World::camera, Number>;
template <auto Number>
constexpr auto encoder = knob_at<&World::encoder, Number>;
template <auto Number>
constexpr auto scene = knob_at<&World::scene, Number>;

constexpr auto log_scale = KnobScale::log;
constexpr std::string_view mpu6000 = "MPU-6000 data sheet rev 3.4, table 6.1";
constexpr std::string_view murata = "Murata CERALOCK catalogue P16E";

constexpr std::array all_knobs{
    Knob{"servo.damping", servo<&ServoWorld::damping>, "", 0.3, 1.2, "assumed: no data sheet states it",
         "damping ratio of a positional servo's own loop"},
    Knob{"servo.backlash_deg", servo<&ServoWorld::backlash_deg>, "deg", 0, 3,
         "assumed: from good to worn gears", "play between gear and shaft"},
    Knob{"servo.stick_deg", servo<&ServoWorld::stick_deg>, "deg", 0, 2.5,
         "assumed: stick-slip below 20 to 50 deg/s",
         "a resting shaft starts at so large an error, a turning one stops at half of it"},
    Knob{"servo.cold_friction_deg", servo<&ServoWorld::cold_friction_deg>, "deg", 0, 2,
         "assumed: grease in a cold gear", "lag by friction that is gone after some minutes (120 s)"},
    Knob{"servo.dead_band_deg", servo<&ServoWorld::dead_band_deg>, "deg", 0, 1.3,
         "sellers' data of analogue servos: 3 to 10 us", "added to the honest servo's own 0.2 to 0.5"},
    Knob{"servo.load_deg", servo<&ServoWorld::load_deg>, "deg", 0, 2, "assumed: a head out of balance",
         "the shaft gives way by so much, as the sine of its angle"},
    Knob{"servo.ripple", servo<&ServoWorld::ripple>, "", 0, 0.03, "assumed: a wheel off its centre",
         "amplitude of the shaft's speed against the gear's"},
    Knob{"servo.ripple_period_deg", servo<&ServoWorld::ripple_period_deg>, "deg", 12, 180,
         "assumed: a tooth to half a turn", "angle over which the ripple repeats", log_scale},
    Knob{"servo.top_speed_dps", servo<&ServoWorld::top_speed_dps>, "deg/s", 160, 600,
         "sellers' data: 0.16 to 0.23 s for 60 deg, 60 % of it with a head on",
         "ceiling of the honest servo's own 375 to 600"},
    Knob{"servo.supply_sag", servo<&ServoWorld::supply_sag>, "", 0, 0.6, "assumed: batteries, a USB port",
         "share of its top speed that a servo loses while it turns at it (within 2 s)", KnobScale::linear,
         Comes::by_chance},

    Knob{"clock.error_ppm", servo_clock<&ServoClockWorld::error_ppm>, "1e-6", -5000, 5000, murata,
         "constant error of a ceramic resonator, beside the crystal's 30"},
    Knob{"clock.warm_up_ppm", servo_clock<&ServoClockWorld::warm_up_ppm>, "1e-6", -300, 300,
         "the same: 0.2 % within 50 K; 7.5 K assumed",
         "error at the start that is gone after minutes (120 s)"},
    Knob{"clock.wave_ppm", servo_clock<&ServoClockWorld::wave_ppm>, "1e-6", 0, 40,
         "the same: 40 a kelvin; a room that swings by 1 K", "amplitude of a wave over minutes"},
    Knob{"clock.wave_period_s", servo_clock<&ServoClockWorld::wave_period_s>, "s", 60, 1200,
         "assumed: a heating's cycle", "its period", log_scale},

    Knob{"links.baud_error", links<&LinksWorld::baud_error>, "", -0.02, 0.02,
         "ATmega328P data sheet, UBRR table: 2.1 % at 115200 baud",
         "all three lines are faster by so much than the profile says"},
    Knob{"links.hub_delay_ms", links<&LinksWorld::hub_delay_ms>, "ms", 0, 3, "assumed",
         "what a shared hub adds to each transfer"},
    Knob{"links.hub_jitter_ms", links<&LinksWorld::hub_jitter_ms>, "ms", 0, 3, "assumed",
         "up to so much more, new in each USB frame and the same for all ports"},
    Knob{"links.stall_ms", links<&LinksWorld::stall_ms>, "ms", 0, 200, "assumed: a computer that is busy",
         "nothing is read from any port for up to so long"},
    Knob{"links.stall_interval_s", links<&LinksWorld::stall_interval_s>, "s", 1, 30, "assumed",
         "how often that happens, on average", log_scale},
    Knob{"links.frame_jitter_ms", links<&LinksWorld::frame_jitter_ms>, "ms", 0, 1,
         "USB 2.0, chapter 5: anywhere in a frame of 1 ms",
         "a transfer comes up to so much after its frame's begin"},
    Knob{"links.read_delay_ms", links<&LinksWorld::read_delay_ms>, "ms", 0, 10,
         "a public log of an MPU6050: 1 % of arrivals later than 69 ms",
         "reads come late by so much on average, exponentially"},
    Knob{"links.host_slew_ppm", links<&LinksWorld::host_slew_ppm>, "1e-6", -500, 500,
         "adjtimex(2), ntpd: 500 at most, and CLOCK_MONOTONIC follows",
         "the host's clock is slewed so for the first half of every 240 s"},

    Knob{"gyro.bandwidth_hz", gyro<&GyroWorld::bandwidth_hz>, "Hz", 5, 256,
         "MPU-6000 register map, DLPF_CFG; WitMotion, register 0x1F", "low-pass of second order; 256: none",
         log_scale},
    Knob{"gyro.cross_axis", gyro<&GyroWorld::cross_axis>, "", 0, 0.02, mpu6000,
         "share of the rate that the other two axes show"},
    Knob{"gyro.g_sensitivity_dps", gyro<&GyroWorld::g_sensitivity_dps>, "deg/s/g", 0, 0.1, mpu6000,
         "error by gravity on a shaft that leans by 5 deg, and by 5 cm off its axis"},
    Knob{"gyro.self_heating_k", gyro<&GyroWorld::self_heating_k>, "K", 0, 10, "assumed",
         "so much colder at the start"},
    Knob{"gyro.self_heating_s", gyro<&GyroWorld::self_heating_s>, "s", 30, 600, "assumed",
         "time constant of that", log_scale},
    Knob{"gyro.bias_per_k_dps", gyro<&GyroWorld::bias_per_k_dps>, "deg/s/K", -0.3, 0.3,
         "MPU-6000, table 6.1: 20 deg/s from -40 to 85 degC", "bias by temperature; needs self-heating"},
    Knob{"gyro.scale_per_k", gyro<&GyroWorld::scale_per_k>, "1/K", -0.0003, 0.0003,
         "MPU-6000, table 6.1: 2 % from -40 to 85 degC", "scale by temperature; needs self-heating"},
    Knob{"gyro.scale_change", gyro<&GyroWorld::scale_change>, "", -0.01, 0.01, "assumed",
         "since the calibration: calibrate in a world without it"},
    Knob{"gyro.vibration_dps", gyro<&GyroWorld::vibration_dps>, "deg/s", 0, 5, "assumed",
         "standard deviation of what gears add to each sample while the shaft turns"},
    Knob{"gyro.zero_below_dps", gyro<&GyroWorld::zero_below_dps>, "deg/s", 0, 1,
         "WitMotion, registers 0x61 and 0x63; a real log",
         "rates are exactly 0 after a second below; 0: never", KnobScale::linear, Comes::by_chance},
    Knob{"gyro.unit", gyro<&GyroWorld::unit>, "", 0.0076, 131, "sketches print rad/s, mdeg/s, counts",
         "it sends so many times what the profile says that it sends", log_scale, Comes::when_named},
    Knob{"gyro.mounted_deg", gyro<&GyroWorld::mounted_deg>, "deg", 0, 180, "a board lies as it fits",
         "its axis stands so far from the shaft's; 90: another axis, 180: reversed", KnobScale::linear,
         Comes::when_named},

    Knob{"camera.rolling_rows", camera<&CameraWorld::rolling_rows>, "", -1, 1,
         "assumed: the data sheet does not say when rows are integrated",
         "rows are integrated one after the other over so much of a refresh period; below 0 from the last"},
    Knob{"camera.lost_subpages", camera<&CameraWorld::lost_subpages>, "", 0, 0.33,
         "a public recording: one in three", "share of half-frames that the bridge misses", KnobScale::linear,
         Comes::by_chance},
    Knob{"camera.repeated_frames", camera<&CameraWorld::repeated_frames>, "", 0, 0.05,
         "a public recording with 14 of them", "share of frames in whose place the one before is sent",
         KnobScale::linear, Comes::by_chance},
    Knob{"camera.membrane_lag_ms", camera<&CameraWorld::membrane_lag_ms>, "ms", 4, 40,
         "assumed: the data sheet does not state it", "time constant of the pixels' membranes", log_scale},
    Knob{"camera.extra_latency_ms", camera<&CameraWorld::extra_latency_ms>, "ms", 0, 30,
         "assumed: firmware of bridges differs", "added to the honest bridge's 16 to 24"},
    Knob{"camera.tilt_deg", camera<&CameraWorld::tilt_deg>, "deg", -5, 5,
         "MLX90640 data sheet: a lens points wrong by up to 5 deg", "the camera looks upward by so much"},
    Knob{"camera.roll_deg", camera<&CameraWorld::roll_deg>, "deg", -5, 5, "assumed: mounted by hand",
         "turned about its optical axis"},
    Knob{"camera.lever_arm_m", camera<&CameraWorld::lever_arm_m>, "m", -0.05, 0.05, "assumed: size of a head",
         "in front of the shaft's axis; what it does depends on scene.distance_m"},
    Knob{"camera.pitch_error", camera<&CameraWorld::pitch_error>, "", -0.03, 0.03,
         "assumed: the data sheet states no tolerance", "the field of view is wider by so much"},
    Knob{"camera.distortion", camera<&CameraWorld::distortion>, "", -0.05, 0.05, "assumed",
         "corners look further out by so much, growing with the square"},
    Knob{"camera.warm_up_k", camera<&CameraWorld::warm_up_k>, "K", 0, 2,
         "public recordings: medians drift by 0.3 to 2 K", "offset of all pixels at the start (120 s)"},
    Knob{"camera.dead_pixels", camera<&CameraWorld::dead_pixels>, "pixels", 0, 4,
         "MLX90640 data sheet: up to 4", "beside the honest camera's own; rounded"},
    Knob{"camera.turned_over", camera<&CameraWorld::turned_over>, "", 0, 1, "bridges differ",
         "1: its image is mirrored otherwise than the profile says; rounded", KnobScale::linear,
         Comes::when_named},

    Knob{"encoder.once_deg", encoder<&EncoderWorld::once_deg>, "deg", 0, 2,
         "assumed: a magnet up to 0.5 mm off the axis", "amplitude of an AS5600's error once a turn"},
    Knob{"encoder.twice_deg", encoder<&EncoderWorld::twice_deg>, "deg", 0, 0.5,
         "AS5600 data sheet: 1 deg in all with a centred magnet", "amplitude of its error twice a turn"},
    Knob{"encoder.failed_reads", encoder<&EncoderWorld::failed_reads>, "", 0, 0.05,
         "assumed: long wires, weak pull-ups", "share of its readings that fail", KnobScale::linear,
         Comes::by_chance},
    Knob{"encoder.weak_magnet", encoder<&EncoderWorld::weak_magnet>, "", 0, 1,
         "AS5600 data sheet, STATUS: ML", "1: the magnet is too far off, twice the noise; rounded",
         KnobScale::linear, Comes::when_named},

    Knob{"scene.distance_m", scene<&SceneWorld::distance_m>, "m", 0.7, 20, "assumed: a desk to a garden",
         "mean distance of what is seen, half and one and a half of it around the rig", log_scale},
    Knob{"scene.person_dps", scene<&SceneWorld::person_dps>, "deg/s", 0, 40, "1 m/s in 1.4 m distance",
         "a person walks to and fro so fast; 0: nobody", KnobScale::linear, Comes::by_chance},
    Knob{"scene.pet_dps", scene<&SceneWorld::pet_dps>, "deg/s", 0, 60, "assumed",
         "a pet on the floor runs to and fro so fast; 0: none", KnobScale::linear, Comes::by_chance},
    Knob{"scene.sun_k", scene<&SceneWorld::sun_k>, "K", 0, 15, "assumed",
         "a patch of sun on a wall, which wanders by 15 deg an hour; clouds come and go", KnobScale::linear,
         Comes::by_chance},
    Knob{"scene.contrast", scene<&SceneWorld::contrast>, "", 0.25, 1.2,
         "assumed: emissivity of metal to paint", "differences of temperature, of the honest scene's",
         log_scale},
    Knob{"scene.saturation_c", scene<&SceneWorld::saturation_c>, "degC", 40, 300,
         "MLX90640 data sheet: 300; lower ones assumed", "nothing is seen as hotter than that", log_scale}};

}  // namespace

std::span<const Knob> world_knobs() {
  return all_knobs;
}

}  // namespace thermorig::simulation
