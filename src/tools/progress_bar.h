#pragma once
/**
 * @file progress_bar.h
 * @brief A bar with the time left on the error output: only on a terminal, only once the work has lasted two seconds.
 */
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>

namespace frictional_contact_sim
{
namespace tools
{
/** @brief Seconds as a person says them: 8 s, 3 min 20 s, 2 h 5 min. */
inline std::string sayDuration(double seconds)
{
  const long whole = std::lround(seconds);
  if (whole < 60)
    return std::to_string(whole) + " s";
  if (whole < 3600)
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

/**
 * @brief Drawn four times a second by a thread of its own, so that a single long piece of work has a bar as well. Where
 * nothing is known of the share that is done, it shows the time gone by; else the time left, were the rest as fast.
 */
class ProgressBar
{
public:
  /** @param total pieces of work; 0: not known @param text stands behind the bar */
  explicit ProgressBar(long total, std::string text = "")
    : total_(total), text_(std::move(text)), start_(std::chrono::steady_clock::now())
  {
    if (isatty(STDERR_FILENO) != 0)
      thread_ = std::thread(&ProgressBar::show, this);
  }
  ~ProgressBar()
  {
    if (!thread_.joinable())
      return;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      finished_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(long done)
  {
    if (!thread_.joinable())
      return;
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = done;
  }

  /** @brief Wipes the bar, and keeps it away as long as what it returns lives: for a line of text. */
  [[nodiscard]] std::unique_lock<std::mutex> pause()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    wipe();
    return lock;
  }

private:
  static constexpr size_t WIDTH = 40;

  void show()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!changed_.wait_for(lock, std::chrono::milliseconds(250), [this] { return finished_; }))
    {
      const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
      if (elapsed >= 2.0)
        draw(elapsed);
    }
    wipe();
  }

  void draw(double elapsed)
  {
    const double share = total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0.0;
    const auto filled = static_cast<size_t>(share * WIDTH);
    std::string line = '[' + std::string(filled, '#') + std::string(WIDTH - filled, '.') + "] ";
    if (total_ > 0)
      line += std::to_string(static_cast<int>(100.0 * share)) + " %, ";
    line += share > 0.0 ? sayDuration(elapsed * (1.0 - share) / share) + " left" : sayDuration(elapsed);
    std::cerr << "\r\033[K" << line << (text_.empty() ? "" : ", ") << text_ << std::flush;
    shown_ = true;
  }

  void wipe()
  {
    if (shown_)
      std::cerr << "\r\033[K" << std::flush;
    shown_ = false;
  }

  long total_;
  long done_ = 0;
  std::string text_;
  bool shown_ = false;
  bool finished_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::chrono::steady_clock::time_point start_;
  std::thread thread_;
};

}  // namespace tools
}  // namespace frictional_contact_sim
