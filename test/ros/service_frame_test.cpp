// The frame around all handlers: whatever they throw becomes an answer in one line.
#include <frictional_contact_sim/Step.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>

#include "frictional_contact_sim/ros/services.h"

namespace frictional_contact_sim
{
namespace
{
TEST(ServiceFrameTest, AHandlerThatReturnsIsASuccessAndItsMessageStays)
{
  std_srvs::SetBool::Response response;
  EXPECT_TRUE(answer("name", response, [&] { response.message = "worth reading"; }));
  EXPECT_TRUE(response.success);
  EXPECT_EQ(response.message, "worth reading");
}

TEST(ServiceFrameTest, AnExceptionIsAnAnswerInOneLine)
{
  std_srvs::SetBool::Response response;
  response.success = true;
  EXPECT_TRUE(answer("name", response, [] { throw RequestError("n: found '\n', expected 1"); }));
  EXPECT_FALSE(response.success);
  EXPECT_EQ(response.message, "n: found ' ', expected 1");
  EXPECT_TRUE(answer("name", response, [] { throw std::bad_alloc(); }));
  EXPECT_FALSE(response.success);
  EXPECT_FALSE(response.message.empty());
}

TEST(ServiceFrameTest, WhatTheHandlerFilledBeforeItFailedIsAnswered)
{
  Step::Response response;
  const auto stop = [&]
  {
    response.report.step = 7;
    throw RequestError("stopped");
  };
  EXPECT_TRUE(answer("step", response, stop));
  EXPECT_FALSE(response.success);
  EXPECT_EQ(response.report.step, 7U);
}

TEST(ServiceFrameTest, AServiceWithoutAnAnswerFailsAtTheCaller)
{
  std_srvs::Empty::Response response;
  EXPECT_TRUE(answer("reset", response, [] {}));
  EXPECT_FALSE(answer("reset", response, [] { throw RequestError("no"); }));
}

}  // namespace
}  // namespace frictional_contact_sim
