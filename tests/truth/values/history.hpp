// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

/// Random histories of how a board stands: commands of several programs, levels and distances, restarts of
/// the board, broker and gateway, lost lines and readers, and commands that contradict a meaning, in
/// simulated time. A real agent, gateway, registry and export stand between a scripted board and what is
/// asked, and each view is compared with what the board did: the agent's answer and what asipctl prints of
/// it, $values, the gateway's HTTP, the state topics of Home Assistant, Homie and the Web of Things or the
/// metrics of Sparkplug (each history has another one), and the list that is made of the registry's answer.
/// What single tests show of it. The rules of docs/service-bus.md, "Properties and their values":
///  reading changes nothing                   ValuesOfBoard.Asked_TheBoardIsSentNothing,
///                                            RealBoardTest.NoReading_SwitchesALampOff; run_lamp() here
///  but inputs, by an agent that starts       LevelsOfABoard.NotTold_InputsAreSetOnceMore_OutputsNever,
///                                            LevelsOfABoard.Told_AreAskedAndNothingIsSet,
///                                            KnownValuesTest.NewInputWithoutAnEvent_IsLow
///  who asks sees what was answered before    ValuesOfBoard.Command_ShowsAtOnceToReadersThatAsk
///  who is told sees it in a tenth of a       ValuesOfBoard.Command_IsToldWithinATenthOfASecond,
///  second, and goes back to nothing older    StandingTest.OlderDocuments_AreDroppedAndCounted
///  each value is known somehow, or not       KnownValuesTest.CommandInDoubt_LeavesTheValueUnknown,
///                                            KnownValuesTest.DriveAndStop_SetThePowerOfTheMotors,
///                                            KnownValuesTest.ModeOfAPin_EndsWhatWasWritten
///  a board that is away, and is back
///                              ValuesOfBoard.BoardAway_LastValuesStayAndAreUnknownAfterTheReturn
///  a pin that nothing holds has no value     PinProperty.ClassOfAnInputWithoutAMode_Floats,
///                                            KnownValuesTest.PinThatFloats_HasNoValueUntilItIsAnInput
///  an event of a button is told once         StandingVectors.WhatIsToldOfButtons_IsWhatTheFileSays
///  buttons and doors do not bounce           ContactTest, Button.Contact_BouncesUnlessItIsSteady,
///                                            RealBoardTest.ButtonThatBounces_IsOnePressAndOneRelease
///  a contradicting command refuses writes
///                              PinProperty.CommandThatContradictsTheMeaning_RefusesTheWriteAndSaysWhy,
///                              StandingTest.PutOfAValueThatIsRefused_SaysWhyAndSendsNothing,
///                              ExporterTest.CommandThatThePropertyRefuses_IsTheLastErrorAndNotSent,
///                              SparkplugNodeTest.CommandThatThePropertyRefuses_IsAnsweredAndNotSent,
///                              and the histories here
/// What a user saw before there were properties:
///  1 reading switches a lamp off             as above
///  2 the same from Python, and toggle        test_reading_sets_nothing_whatever_the_pin_is,
///                                            test_toggle_works_from_what_any_program_set
///  3 an analog pin by its name               test_analog_pin_by_name
///  4 a button is on when it is released      PinProperty.InputWithPullUp_IsOnWhenLow,
///                                            RealBoardTest.MeaningOfAPin_ShowsInItsValue,
///                                            HomeAssistantMeaning.OfAPin_IsItsPlatformAndClass
///  5 a value that lags behind its command    ValuesOfBoard.Command_ShowsAtOnceToReadersThatAsk
///  6 a form that shows another value         tests/browser/services_test.py
///  7 ids that a new command moves            PropertyIds.CommandInFront_ChangesNoOtherId,
///                                            PropertyIds.StandardModels_AreThoseOfTheCommittedTable
///  8 values that cannot be                   ExporterTest.ValueThatThePropertyCannotHave_IsCountedAndNotSent
///  9 names said twice; 0 cm without an echo  HomeAssistantNames.OfTheDevice_AreNotSaidTwice,
///                                            ValueOf.NumberThatSaysNone_IsNoValue,
///    "Pin 14"; energy without a class; no    PinProperty.CommandedMode_DecidesWithoutAMeaning,
///    link; no device of the gateway          HomeAssistantMeaning.OfAnAnalogPin_IsItsClassWithItsUnit,
///                                            HomeAssistantDocument.LinksToThePageOfTheBoard,
///                                            ExporterTest.Gateway_IsADeviceWithDiagnostics
/// 10 arguments by name; toggle; get of a     EncodeWords.ArgumentsByName_InAnyOrder,
///    servo                                   RealBoardTest.PinsInWords_AreSetAndRead,
///                                            RealBoardTest.ListShowSendAndSubscribe_WorkOnIt
/// 11 one list for all                        tests/unit/property/, which no other folder repeats
/// Damaged, enormous and lying lists: PropertyList.Damaged_IsRefusedWithThePlace,
/// StandingTest.DamagedDocuments_AreDroppedAndCounted_AndTheNextOneWorks.
/// Bytes and work: RetainedOfABoard.Properties_AtMostDoubleTheBytes, tests/figures.
namespace truth::values {

struct End {
    std::string failure;             ///< empty: nothing was wrong
    std::vector<std::string> trace;  ///< what happened, where it was asked for
    std::uint64_t looks = 0;         ///< values that were compared
    std::uint64_t known = 0;         ///< of these, values that a view knew
    std::uint64_t reads = 0;
};

End run_history(std::uint64_t seed, bool traced);
/// A lamp that is on, and so many reads beside other commands: it is never dark.
End run_lamp(std::uint64_t seed, unsigned reads);

}  // namespace truth::values
