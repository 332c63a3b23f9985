// SPDX-License-Identifier: Apache-2.0
#include <spawn.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/program/options.hpp"
#include "asip/text/printable.hpp"
#include "cli/context.hpp"
#include "cli/declaration.hpp"
#include "cli/http_post.hpp"

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

int run_open(const OpenOptions& options, Context& context) {
    if (!options.board.empty() && !model::valid_board_name(options.board))
        return context.fail_with({program::kExitUsage, model::explain_board_name(options.board)});
    auto gateway = options.gateway.empty() ? program::environment_variable("ASIP_GATEWAY").value_or("")
                                           : options.gateway;
    if (gateway.empty()) gateway = "http://127.0.0.1:8080";
    const auto address = parse_http_address(gateway);
    if (!address) return context.fail_with({program::kExitUsage, "--gateway: " + address.error()});
    const auto token = token_of(options);
    if (!token) return context.fail_with(token.error());
    const auto answer = http_post(*address, "/api/codes", *token, context.mqtt.ca_file, context.timeout);
    if (!answer) {
        return context.fail_with({program::kExitNoAnswer,
                                  answer.error() + "; is asip-gateway running there? (--gateway ADDRESS)"});
    }
    const auto body = model::parse_json(answer->body);
    const auto member = [&](const char* name) {
        const auto found = body && body->is_object() ? body->find(name) : nlohmann::json::const_iterator();
        const bool text = body && body->is_object() && found != body->end() && found->is_string();
        return text ? found->get<std::string>() : std::string();
    };
    if (answer->status != 200 || member("code").empty()) {
        return context.fail_with(
            {program::kExitFailure, "the gateway refuses: " + text::printable(member("detail"), 300)});
    }
    const auto page = address->text() + "/?code=" + member("code") +
                      (options.board.empty() ? std::string() : "#/board/" + options.board);
    context.out << page << std::endl;
    if (options.print || !context.terminal()) return program::kExitOk;
    if (!start_browser(page)) context.note("open this address in a browser, within 30 seconds");
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
    return [options](Context& context) { return run_open(*options, context); };
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
