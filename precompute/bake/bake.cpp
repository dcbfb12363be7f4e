// SPDX-License-Identifier: GPL-3.0-or-later
// Threads across pairs, one journal, resume by comparison.
#include "precompute/bake/bake.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "formats/io/error.hpp"

namespace palpate::bake {
namespace {

using Clock = std::chrono::steady_clock;

/// A pair in full takes about as long as this many normal indentations; used until one of each has been timed.
constexpr double kFullOverNormal = 5;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Compares what a pair gives now with what the journal already holds of it, and appends what is new.
class PairSink {
public:
  PairSink(std::uint32_t pair, const PairPlan& plan, const JournalPair& known, Journal& journal)
      : pair_(pair), plan_(plan), known_(known), journal_(journal) {}

  void operator()(const Sample& sample) {
    const auto same_place = [&](const Sample& s) { return s.kind == sample.kind && s.index == sample.index; };
    const auto at = std::find_if(known_.samples.begin(), known_.samples.end(), same_place);
    if (at == known_.samples.end()) {
      journal_.append(pair_, sample);
    } else if (same_bits(*at, sample)) {
      ++met_;
    } else {
      differ("sample " + std::to_string(sample.index) + " differs");
    }
  }

  /// At the pair's end: checks that it gave everything the journal holds of it.
  void finish(const std::optional<PairCheck>& check) const {
    if (met_ < known_.samples.size()) {
      differ(std::to_string(known_.samples.size() - met_) + " samples of the journal did not come again");
    }
    if (known_.check && !(check && same_bits(*known_.check, *check))) differ("its check differs");
    if (check && !known_.check) journal_.append(pair_, *check);
  }

private:
  [[noreturn]] void differ(const std::string& what) const {
    throw Error(ExitCode::numerical, describe(pair_, plan_) + " was solved again and " + what +
                                         ": another version of the program or library? Remove the work folder");
  }

  std::uint32_t pair_;
  const PairPlan& plan_;
  const JournalPair& known_;
  Journal& journal_;
  std::size_t met_ = 0;
};

/// Time that pairs take, by what is solved at them, for a time left that does not depend on their order.
class PairTimes {
public:
  void open(const PairPlan& pair) { ++kind(pair).open; }
  void done(const PairPlan& pair, double seconds) {
    Kind& k = kind(pair);
    --k.open;
    ++k.done;
    k.seconds += seconds;
  }
  /// s of one thread for all open pairs; -1 before the first is done.
  [[nodiscard]] double left() const {
    const auto mean = [](const Kind& k) { return k.done > 0 ? k.seconds / static_cast<double>(k.done) : 0.0; };
    const auto& [full, normal] = kinds_;
    if (full.done + normal.done == 0) return -1;
    const double of_full = full.done > 0 ? mean(full) : kFullOverNormal * mean(normal);
    const double of_normal = normal.done > 0 ? mean(normal) : mean(full) / kFullOverNormal;
    return of_full * static_cast<double>(full.open) + of_normal * static_cast<double>(normal.open);
  }

private:
  struct Kind {
    std::size_t open = 0, done = 0;
    double seconds = 0.0;
  };
  Kind& kind(const PairPlan& pair) { return kinds_[pair.role == PairRole::full ? 0 : 1]; }
  std::array<Kind, 2> kinds_;
};

/// One run over the open pairs.
class Run {
public:
  Run(const std::vector<PairPlan>& pairs, const PairSolver& solve, Journal& journal, const BakeOptions& options)
      : pairs_(pairs), solve_(solve), journal_(journal), options_(options), outcomes_(pairs.size()) {
    for (const auto& [pair, content] : journal.content().pairs) {
      if (pair >= pairs.size()) {
        throw Error(ExitCode::bad_input, "the journal holds pair " + std::to_string(pair) + ", the plan has only " +
                                             std::to_string(pairs.size()));
      }
      outcomes_[pair] = content.outcome;
    }
    for (std::uint32_t pair = 0; pair < pairs.size(); ++pair) {
      if (!wanted(pair)) continue;
      ++total_;
      if (!outcomes_[pair]) {
        open_.push_back(pair);
        times_.open(pairs[pair]);
      } else if (!outcomes_[pair]->accepted) {
        ++refused_;
      }
    }
    resumed_ = done_ = total_ - open_.size();
  }

  BakeReport run() {
    unsigned count = options_.threads > 0 ? options_.threads : std::max(1U, std::thread::hardware_concurrency());
    count = static_cast<unsigned>(std::min<std::size_t>(count, open_.size()));
    threads_ = working_ = count;
    std::vector<std::jthread> workers;
    workers.reserve(count);
    for (unsigned k = 0; k < count; ++k) workers.emplace_back([this] { work(); });
    try {
      watch();
    } catch (...) {  // of the progress callback: the workers stop, then the caller gets it
      halt_ = true;
      throw;
    }
    workers.clear();  // joins
    journal_.sync();
    if (error_) std::rethrow_exception(error_);
    return report();
  }

private:
  [[nodiscard]] bool wanted(std::uint32_t pair) const { return !options_.wanted || options_.wanted(pair); }

  void work() {
    try {
      while (!halt_.load()) {
        const std::size_t next = next_.fetch_add(1);
        if (next >= open_.size()) break;
        solve_one(open_[next]);
      }
    } catch (...) {  // kept whole, rethrown by the calling thread
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      halt_ = true;
    }
    const std::lock_guard lock(mutex_);
    --working_;
    wake_.notify_all();
  }

  void solve_one(std::uint32_t pair) {
    const auto known = journal_.content().pairs.find(pair);
    PairSink sink(pair, pairs_[pair], known == journal_.content().pairs.end() ? none_ : known->second, journal_);
    const Clock::time_point began = Clock::now();
    const PairResult result = solve_(pairs_[pair], std::ref(sink));
    sink.finish(result.check);
    journal_.append(pair, result.outcome);
    const std::lock_guard lock(mutex_);
    outcomes_[pair] = result.outcome;
    times_.done(pairs_[pair], seconds_since(began));
    ++done_;
    if (!result.outcome.accepted) ++refused_;
  }

  /// Waits for the workers, reports progress, passes the stop flag on.
  void watch() {
    double told = 0;
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait_for(lock, std::chrono::milliseconds(50), [this] { return working_ == 0; });
      if (options_.stop && options_.stop()) halt_ = true;
      const double now = seconds_since(start_);
      const bool over = working_ == 0;
      if (options_.progress && (over || now - told >= options_.interval)) {
        told = now;
        const BakeProgress progress = progress_at(now);
        lock.unlock();
        options_.progress(progress);
        lock.lock();
      }
      if (over) return;
    }
  }

  [[nodiscard]] BakeProgress progress_at(double now) const {
    BakeProgress p{total_, done_, refused_, now, 0.0, -1.0};
    if (done_ > resumed_ && now > 0) {
      p.per_hour = 3600.0 * static_cast<double>(done_ - resumed_) / now;
      p.seconds_left = times_.left() / threads_;
    }
    return p;
  }

  [[nodiscard]] BakeReport report() const {
    BakeReport r;
    r.total = total_;
    r.resumed = resumed_;
    r.torn_bytes = journal_.content().torn_bytes;
    r.seconds = seconds_since(start_);
    for (std::uint32_t pair = 0; pair < pairs_.size(); ++pair) {
      const auto& outcome = outcomes_[pair];
      if (!wanted(pair)) continue;
      if (!outcome) {
        r.stopped = true;
        continue;
      }
      r.normal_solves += outcome->normal_solves;
      r.tangential_solves += outcome->tangential_solves;
      r.factorisations += outcome->factorisations;
      if (outcome->accepted) {
        ++r.accepted;
        if (!outcome->cause.empty()) ++r.shortened;
      } else {
        r.refused.push_back({pair, outcome->cause});
      }
    }
    return r;
  }

  const std::vector<PairPlan>& pairs_;
  const PairSolver& solve_;
  Journal& journal_;
  const BakeOptions& options_;
  const JournalPair none_;
  std::vector<std::uint32_t> open_;
  std::size_t total_ = 0, resumed_ = 0;  // wanted, finished before
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> halt_{false};

  std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::vector<std::optional<PairOutcome>> outcomes_;
  PairTimes times_;
  std::size_t done_ = 0, refused_ = 0;
  unsigned threads_ = 1, working_ = 0;
  std::exception_ptr error_;
};

}  // namespace

std::string describe(std::uint32_t pair, const PairPlan& plan) {
  const char* const place = plan.role == PairRole::hidden ? " (hidden place " : " (site ";
  return "pair " + std::to_string(pair) + place + std::to_string(plan.site) + ", tool " + std::to_string(plan.tool) +
         ", vertex " + std::to_string(plan.tool_vertex) + ")";
}

BakeReport bake_pairs(const std::vector<PairPlan>& pairs, const PairSolver& solve, Journal& journal,
                      const BakeOptions& options) {
  return Run(pairs, solve, journal, options).run();
}

}  // namespace palpate::bake
