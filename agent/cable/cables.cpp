// SPDX-License-Identifier: Apache-2.0
#include "agent/cable/cables.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "asip/model/names.hpp"
#include "asip/program/log.hpp"

namespace asip::agent {
namespace {

namespace fs = std::filesystem;
namespace log = program::log;
using link::CableKind;

constexpr auto kLookAround = std::chrono::minutes(1);
constexpr mode_t kUserAndGroup = 0660;

/// Whoever may write there could take a place, or listen in place of the agent.
void check_folder(const fs::path& folder) {
    struct stat found{};
    if (::lstat(folder.c_str(), &found) != 0)
        throw std::runtime_error(std::generic_category().message(errno));
    if (!S_ISDIR(found.st_mode)) throw std::runtime_error("it is no folder");
    if (found.st_uid != ::geteuid()) throw std::runtime_error("the folder is of another user");
    if ((found.st_mode & (S_IWGRP | S_IWOTH)) != 0)
        throw std::runtime_error("others may write in the folder (chmod 750)");
}

/// Nothing else, of which it may be the only way to it.
void remove_port(const fs::path& path) {
    std::error_code error;
    if (fs::read_symlink(path, error).native().starts_with("/dev/pts/")) fs::remove(path, error);
}

/// An agent that was killed leaves its socket.
void remove_left_over(boost::asio::io_context& io, const std::string& path) {
    if (!fs::is_socket(path)) throw std::runtime_error("something else has this name");
    boost::asio::local::stream_protocol::socket probe(io);
    boost::system::error_code error;
    probe.connect(path, error);
    if (!error) throw std::runtime_error("another asip-agent listens at " + path);
    fs::remove(path);
}

/// Whether it ends as the name of a place that is numbered: anna-2.
bool ends_with_number(const std::string& name) {
    const auto last = name.find_last_not_of("0123456789");
    return last != std::string::npos && last + 1 < name.size() && name[last] == '-';
}

}  // namespace

Cables::Cables(boost::asio::io_context& io, fs::path folder, Handlers handlers)
    : io_(io), folder_(std::move(folder)), handlers_(std::move(handlers)), acceptor_(io), timer_(io) {
    const auto socket = (folder_ / kSocket).string();
    std::error_code made;
    if (fs::create_directories(folder_, made))
        fs::permissions(folder_, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec);
    try {
        check_folder(folder_);
        if (fs::exists(fs::symlink_status(socket))) remove_left_over(io, socket);
        for (const auto& entry : fs::directory_iterator(folder_))
            remove_port(entry.path());
        acceptor_.open();
        acceptor_.bind(socket);
        acceptor_.listen();
    } catch (const std::exception& error) {
        throw std::runtime_error("--cables: cannot listen at " + socket + ": " + error.what());
    }
    ::chmod(socket.c_str(), kUserAndGroup);
    log::info("boards that browsers lend are served here", {{"socket", socket}});
    accept();
    forget_old();
}

Cables::~Cables() {
    stop();
}

void Cables::stop() {
    if (!acceptor_.is_open()) return;
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    timer_.cancel();
    for (const auto& [number, cable] : cables_)
        cable->tell(CableKind::kEnd, "the agent of lent boards was stopped");
    std::error_code error;
    fs::remove(folder_ / kSocket, error);
    for (const auto& [place, at] : places_)
        remove_port(port_of(place));
}

void Cables::accept() {
    acceptor_.async_accept([this](const boost::system::error_code& error, Protocol::socket socket) {
        if (error == boost::asio::error::operation_aborted) return;
        if (!error) {
            const unsigned number = ++last_;
            cables_[number] = std::make_unique<Cable>(
                io_, std::move(socket),
                Cable::Handlers{[this, number](const Cable::Hello& hello) { plug(number, hello); },
                                [this, number](const std::string& why) { pulled(number, why); }});
        }
        accept();
    });
}

// A board without a name of its own takes the place of one of this lender that is there no more. anna-2 is
// the second board of anna, now and after a restart: what is kept under its name is hers. The first one of
// the user anna-2 is anna-2-1.
std::string Cables::place_of_lender(const std::string& by) const {
    auto base = model::suggest_name(by);
    if (base + "-" == link::kPupilPlace) base += "-0";  // student-0-1: student-1 is a pupil's
    const bool numbered = base == kSocket || ends_with_number(base);
    for (std::size_t i = 1; i <= kMaxOfOneLender; ++i) {
        auto place = i == 1 && !numbered ? base : base + "-" + std::to_string(i);
        const auto found = places_.find(place);
        if (found == places_.end()) return places_.size() < kMaxPlaces ? place : std::string();
        if (found->second.cable == 0 && found->second.by == by) return place;
    }
    return {};
}

std::string Cables::place_for(const Cable::Hello& hello) const {
    if (!hello.place.empty()) {
        const bool valid = hello.place.starts_with(link::kPupilPlace) && model::valid_board_name(hello.place);
        return valid && (places_.contains(hello.place) || places_.size() < kMaxPlaces) ? hello.place : "";
    }
    for (const auto& [place, at] : places_)
        if (!hello.cable.empty() && at.by == hello.by && at.name == hello.cable) return place;
    return place_of_lender(hello.by);
}

void Cables::refuse(unsigned number, const std::string& why) {
    log::warning("a lent board is not served", {{"why", why}});
    cables_[number]->tell(CableKind::kEnd, why);
}

void Cables::plug(unsigned number, const Cable::Hello& hello) {
    auto place = place_for(hello);
    if (place.empty() && places_.size() >= kMaxPlaces && forget_oldest()) place = place_for(hello);
    if (place.empty()) return refuse(number, "as many boards are lent as may be");
    const auto terminal = cables_[number]->open_port();
    if (!terminal) return refuse(number, terminal.error());
    remove_port(port_of(place));
    std::error_code error;
    fs::create_symlink(*terminal, port_of(place), error);
    if (error) return refuse(number, port_of(place).string() + ": " + error.message());
    auto& at = places_[place];
    if (const auto before = cables_.find(std::exchange(at.cable, number)); before != cables_.end())
        before->second->replaced();
    at.by = hello.by;
    at.name = hello.cable;
    if (!at.lent) at.lent = std::make_shared<Lent>();
    *at.lent = {hello.vendor, hello.product, {}, !hello.place.empty()};
    log::info("board lent", {{"by", hello.by}, {"port", port_of(place).string()}});
    handlers_.on_plugged(place, port_of(place).string(), at.lent);
}

void Cables::pulled(unsigned number, const std::string& why) {
    for (auto& [place, at] : places_) {
        if (at.cable != number) continue;
        log::info("board not lent any more", {{"place", place}, {"why", why}});
        at.cable = 0;
        at.lent->why_gone = why;
        at.pulled = Clock::now();
        remove_port(port_of(place));
    }
    boost::asio::post(io_, [this, number, alive = std::weak_ptr(alive_)] {
        if (!alive.expired()) cables_.erase(number);
    });
}

void Cables::named(const std::string& place, const std::string& board) {
    const auto at = places_.find(place);
    if (at == places_.end()) return;
    if (const auto cable = cables_.find(at->second.cable); cable != cables_.end())
        cable->second->tell(CableKind::kName, board);
}

void Cables::forget_old() {
    timer_.expires_after(kLookAround);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        std::erase_if(places_, [this](const auto& each) {
            const bool old = each.second.cable == 0 && Clock::now() >= each.second.pulled + kKept;
            if (old) handlers_.on_left(each.first);
            return old;
        });
        forget_old();
    });
}

bool Cables::forget_oldest() {
    const auto oldest =
        std::min_element(places_.begin(), places_.end(), [](const auto& one, const auto& other) {
            return std::pair(one.second.cable != 0, one.second.pulled) <
                   std::pair(other.second.cable != 0, other.second.pulled);
        });
    if (oldest == places_.end() || oldest->second.cable != 0) return false;
    handlers_.on_left(oldest->first);
    places_.erase(oldest);
    return true;
}

}  // namespace asip::agent
