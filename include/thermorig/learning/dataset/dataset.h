// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/label.h"
#include "thermorig/network/acquisition.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::dataset {

/// What training and evaluation need of a session. Frames that no network may see (a label, gyro mean or
/// pixel that is no sound number) are in no run, whatever the file says. The session's samples are one a
/// frame, in order. A label that a file of an older format lacks is NaN: see require_label(). There are no
/// estimates in it.
network::Acquisition acquisition_of(const session::Session& session, const std::string& name,
                                    Label label = Label::commanded);

/// Adds what the estimators that need no network say of the session that the acquisition is of.
/// `bound_frames`: of windows of so many frames the bounds too; 0: none.
void add_estimates(network::Acquisition& acquisition, const session::Session& session, int bound_frames = 0);

/// Throws Error(check_failed) where the session is of a format before that label.
void require_label(const session::Session& session, Label label, const std::filesystem::path& file);

/// "<environment>_acq-<number>", as the file is named but for the time: a simulated session that is recorded
/// again has the same name.
std::string name_of(const session::Session& session);

/// Reads a session file; the name is "<environment>_acq-<number>". Throws Error(not_a_session) as
/// session::read_session does.
network::Acquisition read_acquisition(const std::filesystem::path& path);

/// The session files (.h5) that the paths name: files as they are, folders searched to any depth; sorted,
/// each once. Throws Error(bad_usage) for a path that does not exist and where nothing is found.
std::vector<std::filesystem::path> find_sessions(const std::vector<std::filesystem::path>& paths);

/// The journals in the folders among the paths; sorted, each once. Throws as find_sessions() does, but not
/// where nothing is found.
std::vector<std::filesystem::path> find_journals(const std::vector<std::filesystem::path>& paths);

/// A session whose verdict is bad, and why.
struct BadSession {
  std::filesystem::path file;
  std::vector<std::string> reasons;  // of the verdict, at least one
};

/// What the verdict has against a session; none: it is good or usable.
std::optional<BadSession> bad_session(const session::Session& session, const std::filesystem::path& file);

/// Is told of each file that was read, one at a time: how many were, of how many.
using ReadingProgress = std::function<void(std::size_t done, std::size_t all)>;

/// What files hold for training and evaluation. What is left out, and `bad`, in the order of the files.
struct Acquisitions {
  std::vector<network::Acquisition> acquisitions;      // sorted by environment, number, name
  std::vector<std::filesystem::path> files;            // one each of those
  std::vector<std::filesystem::path> for_calibration;  // left out
  std::vector<BadSession> left_out;                    // since they are bad
  std::vector<BadSession> bad;                         // not left out
};

/// Is a file left out, if its verdict is bad? May be called from several threads.
using LeavesOut = std::function<bool(const std::filesystem::path&)>;

/// Reads all of them, on all cores, with that label; `packs`: the pixels of each, as soon as it is read. Of
/// the bad ones those are left out that `leaves_out` says; empty: none. Throws Error(not_a_session) also
/// where two files hold the same recording, and as require_label().
Acquisitions read_acquisitions(const std::vector<std::filesystem::path>& files,
                               const ReadingProgress& progress = {}, Label label = Label::commanded,
                               bool packs = false, const LeavesOut& leaves_out = {});

/// Whether the estimates of an acquisition are wanted.
using IsWanted = std::function<bool(const network::Acquisition&)>;

/// Reads the files of the acquisitions that are wanted again, which takes a tenth of the time, and adds their
/// estimates, on all cores: minutes for many sessions, so what can be refused is refused before. Throws
/// Error(not_a_session) for a file that holds another recording by now.
void run_estimators_over(Acquisitions& data, const IsWanted& is_wanted, int bound_frames = 0,
                         const ReadingProgress& progress = {});

}  // namespace thermorig::dataset
