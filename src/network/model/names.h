// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace thermorig::model {

// What a model file calls things; docs/model_format.md. The tensors' names are network::tensors_of's.

namespace value {
inline constexpr std::string_view frames = "frames", gyro = "gyro", period = "period";    // inputs
inline constexpr std::string_view fusion = "fusion", thermal = "thermal", gain = "gain";  // outputs
}  // namespace value

namespace key {
inline constexpr std::string_view format = "format", format_version = "format_version";
inline constexpr std::string_view network = "network";
inline constexpr std::string_view frames = "frames", reduction = "reduction";
inline constexpr std::string_view padding1 = "padding1", padding2 = "padding2", crop_left = "crop_left";
inline constexpr std::string_view label_scale_dps = "label_scale_dps";
inline constexpr std::string_view temp_mean_c = "temp_mean_c", temp_deviation_c = "temp_deviation_c";
// Of version 2, in place of the two above.
inline constexpr std::string_view scaling = "scaling", frame_period_s = "frame_period_s";
inline constexpr std::string_view gate_states_sigma = "gate_states_sigma";
inline constexpr std::string_view view_width_deg = "view_width_deg", half_frames = "half_frames";
inline constexpr std::string_view mirrored =
    "mirrored";  // and these two are missing where the view is unknown
inline constexpr std::string_view made_windows = "made_windows", begun_from = "begun_from";
inline constexpr std::string_view preset = "preset", label = "label", seed = "seed";
inline constexpr std::string_view epochs = "epochs", epoch_kept = "epoch_kept";
inline constexpr std::string_view simulated = "simulated", data_licence = "data_licence";
inline constexpr std::string_view training_data = "training_data";  // + "_1", "_2", ...
inline constexpr std::string_view held_out_data = "held_out_data";  // the same
inline constexpr std::string_view weights_crc32 = "weights_crc32";
}  // namespace key

inline constexpr std::string_view format_name = "thermorig model";
inline constexpr int format_version_by_data_set = 1;
inline constexpr int format_version_by_window = 2;  // scaling is in the graph
inline constexpr std::string_view by_window = "window";

}  // namespace thermorig::model
