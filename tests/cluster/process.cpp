// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/process.hpp"

#include <csignal>
#include <utility>

namespace cluster {

Process::Process(std::vector<std::string> command, std::map<std::string, std::string> environment)
    : command_(std::move(command)), environment_(std::move(environment)) {
    start();
}

void Process::start() {
    if (process_) earlier_ = log();
    process_ = std::make_unique<asip::test::ChildProcess>(command_, environment_);
}

void Process::kill() {
    process_->signal(SIGKILL);
    process_->wait_exit();
    earlier_ = log() + "-- killed\n";
    process_.reset();
}

void Process::say_goodbye() {
    process_->signal(SIGTERM);
    process_->wait_exit();
    earlier_ = log();
    process_.reset();
}

void Process::stop() {
    process_->signal(SIGSTOP);
}

void Process::go_on() {
    process_->signal(SIGCONT);
}

std::optional<int> Process::ended_by_itself() {
    if (!process_ || process_->running()) return std::nullopt;
    return process_->wait_exit();
}

std::string Process::log() const {
    return earlier_ + (process_ ? process_->output() + process_->errors() : "");
}

}  // namespace cluster
