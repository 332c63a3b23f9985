// SPDX-License-Identifier: Apache-2.0
#include <spawn.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/program/options.hpp"
#include "asip/text/printable.hpp"
#include "cli/ask/http_request.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"

namespace asip::cli {
namespace {

struct OpenOptions {
    std::string board;
    std::string gateway;
    std::string token_file;
    bool print = false;
};

Outcome<std::string> token_of(const OpenOptions& options) {
    if (options.token_file.empty()) return program::environment_variable("ASIP_TOKEN").value_or("");
    auto token = mqtt::read_password_file(options.token_file);
    if (!token) return failure(program::kExitUsage, "--token-file: " + token.error());
    return *token;
}

// Without a shell: the address goes to the program as it is.
bool start_browser(const std::string& address) {
    std::string program = "xdg-open";
    std::string argument = address;
    char* const arguments[] = {program.data(), argument.data(), nullptr};
    pid_t pid = 0;
    if (posix_spawnp(&pid, program.c_str(), nullptr, nullptr, arguments, environ) != 0) return false;
    int status = 0;
    return waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// A text of a JSON answer; empty where there is none.
std::string text_in(const HttpAnswer& answer, const char* name) {
    const auto body = model::parse_json(answer.body);
    if (!body || !body->is_object()) return {};
    const auto found = body->find(name);
    return found != body->end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// The answer of the gateway, which must be 200.
Outcome<HttpAnswer> answered(Expected<HttpAnswer> answer) {
    if (!answer) {
        return failure(program::kExitNoAnswer,
                       answer.error() + "; is asip-gateway running there? (--gateway ADDRESS)");
    }
    if (answer->status == 200) return std::move(*answer);
    const auto detail = text::printable(text_in(*answer, "detail"), 300);
    if (answer->status == 404 && !detail.empty()) return failure(program::kExitNoAnswer, detail);
    return failure(program::kExitFailure,
                   "the gateway refuses: " + (detail.empty() ? std::to_string(answer->status) : detail));
}

/// The page of a board, or of all, with a code that logs a browser in.
Outcome<std::string> page_of(const HttpAddress& address, const std::string& board, const HttpAccess& access) {
    if (!board.empty()) {
        const auto known = answered(http_get(address, "/api/boards/" + board, access));
        if (!known) return tl::unexpected(known.error());
    }
    const auto answer = answered(http_post(address, "/api/codes", access));
    if (!answer) return tl::unexpected(answer.error());
    const auto code = text_in(*answer, "code");
    if (code.empty()) return failure(program::kExitFailure, "what answers there is no asip-gateway");
    return address.text() + "/?code=" + code + (board.empty() ? std::string() : "#/board/" + board);
}

int run_open(const OpenOptions& options, Environment& environment) {
    if (!options.board.empty() && !model::valid_board_name(options.board))
        return environment.fail_with({program::kExitUsage, model::explain_board_name(options.board)});
    auto gateway = options.gateway.empty() ? program::environment_variable("ASIP_GATEWAY").value_or("")
                                           : options.gateway;
    if (gateway.empty()) gateway = "http://127.0.0.1:8080";
    const auto address = parse_http_address(gateway);
    if (!address) return environment.fail_with({program::kExitUsage, "--gateway: " + address.error()});
    const auto token = token_of(options);
    if (!token) return environment.fail_with(token.error());
    const auto page =
        page_of(*address, options.board, {*token, environment.mqtt.ca_file, environment.timeout});
    if (!page) return environment.fail_with(page.error());
    environment.say(*page);
    if (options.print || !environment.terminal()) return program::kExitOk;
    if (!start_browser(*page)) environment.note("open this address in a browser, within 30 seconds");
    return program::kExitOk;
}

Run declare_open(Declaration& verb) {
    auto options = std::make_shared<OpenOptions>();
    verb.argument("BOARD", options->board, "Whose page; without it, the list of boards",
                  Declaration::Needed::kNo);
    verb.option("--gateway", "ADDRESS", options->gateway,
                "Where asip-gateway is; default: $ASIP_GATEWAY, else http://127.0.0.1:8080");
    verb.option("--token-file", "FILE", options->token_file,
                "File with a token of the gateway; default: $ASIP_TOKEN, else none");
    verb.flag("-p,--print", options->print, "Only print the address");
    return [options](Environment& environment) { return run_open(*options, environment); };
}

}  // namespace

Verb open_verb() {
    return {"open", "Open the web page of a board, or of all",
            "Prints the address with a code that logs a browser in, once, within 30 seconds, and opens it "
            "where there\n"
            "is a desktop.\n"
            "Examples:\n"
            "  asipctl open uno1\n"
            "  asipctl open --gateway https://gateway.example:8443 --token-file ~/.asip-token -p",
            declare_open, false};
}

}  // namespace asip::cli
