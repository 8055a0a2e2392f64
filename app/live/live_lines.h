// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "live_run.h"
#include "print/output_writer.h"

namespace thermorig::app {

/// One line a second of the recording, a heading, and a table at the end.
std::unique_ptr<LiveScreen> make_live_lines(OutputWriter& output);

/// The messages on standard output, one a line, without images.
std::unique_ptr<MessageSink> make_live_json(OutputWriter& output);

/// What the output says of texts that it had no room for: a line, or an object.
std::string dropped_line(const DroppedTexts& dropped);
std::string dropped_object(const DroppedTexts& dropped);

/// What stands before the first line: source, plan, model.
std::string heading_of(const LiveFacts& facts);

/// The figures of a run as a table.
std::string scores_text(const live::LiveScores& scores);

/// How it ended, and the figures.
std::string ending_of(const LiveEnd& end, const live::LiveScores& scores, bool has_servo);

}  // namespace thermorig::app
