#pragma once
#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace asip::cli {

struct Context;

/// A subcommand once its options are read: what to run. The last one chosen on the command line sets it.
using Chosen = std::function<int(Context&)>;

void setup_list(CLI::App& app, Chosen& chosen);
void setup_show(CLI::App& app, Chosen& chosen);
void setup_subscribe(CLI::App& app, Chosen& chosen);
void setup_send(CLI::App& app, Chosen& chosen);
void setup_pin(CLI::App& app, Chosen& chosen);
void setup_ping(CLI::App& app, Chosen& chosen);
void setup_top(CLI::App& app, Chosen& chosen);
void setup_doctor(CLI::App& app, Chosen& chosen);
void setup_forget(CLI::App& app, Chosen& chosen);
void setup_prune(CLI::App& app, Chosen& chosen);
void setup_completion(CLI::App& app, Chosen& chosen);

}  // namespace asip::cli
