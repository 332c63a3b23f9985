// SPDX-License-Identifier: Apache-2.0
#include "cli/record/recording_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace asip::cli {
namespace {

constexpr std::size_t kMuch = std::size_t{64} * 1024;

}  // namespace

Outcome<RecordingWriter> RecordingWriter::create(const std::string& path, bool replace) {
    if (path == "-") {
        if (const int output = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0); output >= 0)
            return RecordingWriter(output, Target::kOutput, path);
        return failure(program::kExitFailure, std::string("standard output: ") + std::strerror(errno));
    }
    constexpr int kFlags = O_CREAT | O_WRONLY | O_CLOEXEC;
    if (const int made = ::open(path.c_str(), kFlags | O_EXCL, 0666); made >= 0)
        return RecordingWriter(made, Target::kCreated, path);
    if (errno == EEXIST && replace) {
        if (const int there = ::open(path.c_str(), kFlags, 0666); there >= 0)
            return RecordingWriter(there, Target::kReplaced, path);
    }
    if (errno == EEXIST)
        return failure(program::kExitFailure,
                       path + " is there already; name another file, or give --replace");
    return failure(program::kExitFailure, path + " cannot be written: " + std::strerror(errno));
}

RecordingWriter::RecordingWriter(RecordingWriter&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      target_(other.target_),
      path_(std::move(other.path_)),
      text_(std::move(other.text_)),
      bytes_(other.bytes_),
      written_(other.written_) {}

RecordingWriter::~RecordingWriter() {
    if (descriptor_ < 0) return;
    (void)flush();
    ::close(descriptor_);
}

void RecordingWriter::discard() {
    text_.clear();
    if (target_ == Target::kCreated) ::unlink(path_.c_str());
}

Expected<void> RecordingWriter::flush_due(Time now) {
    if (text_.empty() || (text_.size() < kMuch && now - written_ < kWithin)) return {};
    written_ = now;
    return flush();
}

Expected<void> RecordingWriter::flush() {
    // Fails for what is no file and has nothing to be replaced.
    if (target_ == Target::kReplaced && bytes_ == 0 && !text_.empty()) (void)!::ftruncate(descriptor_, 0);
    for (std::size_t done = 0; done < text_.size();) {
        const auto count = ::write(descriptor_, text_.data() + done, text_.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            const std::string why = std::strerror(errno);
            text_.clear();
            return fail("the recording cannot be written: " + why);
        }
        done += static_cast<std::size_t>(count);
        bytes_ += static_cast<std::uint64_t>(count);
    }
    text_.clear();
    return {};
}

Outcome<RecordingReader> RecordingReader::open(const std::string& path) {
    RecordingReader reader(path, std::ifstream(path, std::ios::binary));
    std::string line;
    if (!reader.file_)
        return failure(program::kExitFailure, path + " cannot be read: " + std::strerror(errno));
    std::getline(reader.file_, line);
    if (const auto began = parse_recording_header(line); !began)
        return failure(program::kExitFailure, path + ": " + began.error());
    return reader;
}

Outcome<std::optional<RecordedMessage>> RecordingReader::next() {
    std::string line;
    while (std::getline(file_, line)) {
        ++line_;
        if (file_.eof()) return std::optional<RecordedMessage>();
        const auto where = path_ + ", line " + std::to_string(line_) + ": ";
        if (line.size() > kMaxLineBytes) return failure(program::kExitFailure, where + "is too long");
        auto message = parse_recorded(line);
        if (!message) return failure(program::kExitFailure, where + message.error());
        if (*message) return std::move(*message);
    }
    return std::optional<RecordedMessage>();
}

}  // namespace asip::cli
