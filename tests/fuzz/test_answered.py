"""The table of attacks: each has its test, or a program beside what has to be said of it."""

import re
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
MEASURED = "fuzz/test_attacks.py::test_what_is_small_takes_little"

ANSWERED = {
    # Cost that grows with a value
    "exponents of a saved monitor's step": (
        MEASURED,
        "monitoring/test_odd_saved_monitors.py::test_an_odd_value_anywhere_is_refused_or_means_nothing_else",
    ),
    "digits of numbers in traces and examples": (
        "trace/test_written_numbers.py::test_what_is_too_long_is_refused",
        "rulebook/test_hostile.py::test_what_no_one_would_write",
    ),
    "time steps of a recording": (
        MEASURED,
        "recordings/commonroad/test_hostile_files.py::test_one_time_step_far_away",
        "recordings/commonroad/test_hostile_files.py::test_few_states_of_many_for_a_long_time",
    ),
    "choices of objects for a rule's variables": (
        MEASURED,
        "monitoring/test_lazy_bindings.py::test_of_427_million_choices_none_is_made_that_cannot_violate_the_rule",
        "monitoring/test_lazy_bindings.py::test_choices_that_matter_and_are_too_many_are_refused",
        "vocabulary/test_number_of_choices.py::test_more_choices_than_the_limit_are_refused_before_the_first_is_made",
        "programs/bad/many_choices.rules",
    ),
    "objects of one trace": (MEASURED, "cli/test_limit_places.py::test_the_place_is_told"),
    "obstacles and layers of a scenario": (MEASURED,),
    "time of all rules and steps that are compiled": (
        "automata/test_steps.py::test_there_is_a_limit_on_the_time_that_all_rules_take",
    ),
    "what a link to the playground is unpacked to": (
        "playground/test_links.py::test_a_link_is_unpacked_within_bounds",
    ),
    "steps of the traces of one file": (
        MEASURED,
        "automata/test_steps.py::test_there_is_a_limit_on_the_steps_that_are_compiled_for",
        "automata/test_steps.py::test_steps_that_hardly_differ_are_compiled_together",
        "automata/test_steps.py::test_a_bound_of_too_many_steps_is_refused_without_trying",
    ),
    "alternatives of a drawn condition": (
        MEASURED,
        "automata/test_edges.py::test_a_condition_of_too_many_cubes_is_refused_before_it_is_put_together",
    ),
    "states of one trace, and rows that never end": (
        MEASURED,
        "trace/test_large_traces.py::test_a_line_of_too_many_states_is_refused_and_the_others_are_read",
        "trace/test_large_traces.py::test_a_trace_that_goes_on_through_blocks_is_refused_where_it_is_too_long",
        "trace/test_large_traces.py::test_a_row_of_csv_has_an_end",
        "trace/test_large_traces.py::test_many_columns_are_few_enough",
    ),
    "rows that are each refused": (
        "cli/test_limit_places.py::test_the_place_is_told",
        "monitoring/test_verify.py::test_a_refusal_keeps_nothing_of_what_was_at_hand",
    ),
    "explanation of a long trace": (
        MEASURED,
        "monitoring/test_explanation.py::test_a_long_trace_is_shown_around_the_decisive_state",
        "monitoring/test_explanation.py::test_the_states_of_a_window_violate_the_rule_like_all",
    ),
    "types and surfaces that are each held against all others": (
        MEASURED,
        "rulebook/test_hostile.py::test_types_in_a_chain_that_is_too_long_are_cut_where_it_is",
        "scenario/test_bad_input.py::test_surfaces_beyond_number",
    ),
    "more files than may be open": (
        "files/test_files.py::test_any_number_of_files_appear_together_however_few_may_be_open",
    ),
    "limits that the documentation tells": (
        "docs/test_limits.py::test_the_page_lists_the_limits_that_can_be_lifted",
        "docs/test_limits.py::test_the_page_lists_the_limits_that_are_fixed",
        "cli/test_limit_places.py::test_the_place_is_told",
    ),
    # Edges of libraries
    "Parquet whose texts are none": (
        MEASURED,
        "trace/test_tables.py::test_parquet_with_a_text_that_is_not_utf8",
    ),
    "Parquet whose statistics end the process that reads them": (MEASURED,),
    "a damaged cache": (
        "rulebook/test_recollection.py::test_damage_costs_time_only",
        "automata/test_compiled_cache.py::test_a_damaged_file_is_made_anew",
    ),
    "settings with names that are too long": (
        MEASURED,
        "settings/test_search_path.py::test_names_that_are_too_long_are_no_folders",
    ),
    "file names that are no text": (
        "cli/test_streams.py::test_a_name_that_no_encoding_holds",
        "cli/test_hostile_names.py::test_no_line_of_any_output_drives_anything",
    ),
    "pipes and devices in folders": (
        "rulebook/test_source_walk.py::test_links_out_pipes_and_sockets_are_refused_and_the_rest_goes_on",
        "recordings/test_inputs.py::test_links_are_not_followed_and_pipes_not_opened",
        "cli/test_fmt.py::test_a_pipe_is_no_file_to_rewrite",
    ),
    "thresholds beyond all sense": (MEASURED,),
    "an interrupt at any moment": (
        "cli/test_interruption.py::test_while_modules_are_imported",
        "cli/test_interruption.py::test_what_libraries_make_of_an_interrupt_is_one",
        "cli/test_interruption.py::test_where_nothing_can_be_raised",
        "cli/test_monitor.py::test_it_saves_whatever_ends_it",
    ),
    "numbers between two floats": (
        "trace/test_written_numbers.py::test_a_number_counts_as_it_is_written",
        "trace/test_written_numbers.py::test_an_example_says_what_it_says",
        "trace/test_written_numbers.py::test_numbers_differ_that_have_one_nearest_float",
    ),
    # Wrong or missing answers
    "rules that nothing can violate, and rules with a dead exception": (
        "analysis/test_rulebook_findings.py::test_findings",
    ),
    "a headway of another speed than its page names": (
        "extraction/tracks/test_source_tolerances.py::test_time_headway_and_speed_are_of_the_same_speed",
    ),
    "a past with an object of another type": (
        "planning/test_before.py::test_who_is_of_another_type_now_is_somebody_else",
        "monitoring/test_monitor.py::test_who_is_of_another_type_is_another",
    ),
    "predictions that are one motion": (
        "cli/test_maneuvers.py::test_predictions_that_are_one_motion_are_one_world_and_said_to_be",
    ),
    "all engines and the checker against the second reading": (
        "engines/test_random.py::test_all_engines_agree",
        "engines/test_many_cases.py::test_engines_and_the_checker_agree",
    ),
    "refusals that do not say where": (
        "diagnostics/test_places.py::test_what_has_no_place_is_known",
        "diagnostics/test_places.py::test_where_it_is_known_it_is_told",
    ),
    "addresses that no path can be made of, in an editor": (
        "language_server/test_hostile_addresses.py::test_odd_addresses_are_of_documents_without_a_file",
        "language_server/test_hostile_addresses.py::test_what_is_no_source_is_not_read",
    ),
    # Nothing lost
    "an answer in the place of what is read": (
        "cli/test_output_options.py::test_no_answer_takes_the_place_of_what_is_read",
        "cli/test_output_options.py::test_a_source_that_is_there_is_never_written_over",
    ),
    "a file that is called -": (
        "cli/test_output_options.py::test_the_minus_is_standard_input_and_output_whatever_files_are_called",
        "cli/test_standard_input.py::test_other_files_may_come_by_it_too",
        "cli/test_standard_input.py::test_where_it_cannot_be_the_reason_is_said",
    ),
    "a kill between two files of a set": (
        "files/test_files.py::test_a_set_that_was_killed_is_finished_or_undone_by_the_next",
        "files/test_files.py::test_where_one_of_several_files_cannot_be_written_none_appears",
        "files/test_files.py::test_a_planted_manifest_reaches_nothing_elsewhere",
    ),
    "long names, owners and second names of formatted files": (
        "files/test_files.py::test_the_longest_names_can_be_written",
        "files/test_files.py::test_an_owner_is_kept",
        "files/test_files.py::test_an_owner_who_cannot_be_kept_and_a_second_name_are_reasons_not_to",
    ),
    # What was compiled is what is judged
    "bits of compiled files": (
        "automata/test_compiled_file.py::test_a_bit_that_is_not_as_it_was_is_refused",
        "automata/test_compiled_file.py::test_files_without_a_digest_are_refused_with_the_command_that_makes_them_anew",
    ),
    "changed tables with a digest made anew": (
        "validation/test_proofs.py::test_tables_that_judge_otherwise_are_not_proved",
        "validation/test_proofs.py::test_changed_tables_for_cut_traces_are_proved_only_if_nothing_changes",
        "validation/test_proofs.py::test_the_checker_loads_nothing_of_rulec",
    ),
    "compiled files that somebody else has signed": (
        "cli/test_signatures.py::test_what_is_not_signed_is_refused",
        "cli/test_signatures.py::test_a_source_is_never_signed",
    ),
    # Strangers' trees
    "links that lead out, and what stands behind them": (
        "cli/test_hostile_checkout.py::test_it_shows_nothing_from_elsewhere_and_commands_nobody",
        "cli/test_hostile_checkout.py::test_settings_that_are_a_link_stop_every_command",
        "rulebook/test_source_walk.py::test_no_line_of_a_file_that_is_no_source_is_shown",
        "rulebook/test_source_walk.py::test_nothing_is_written_behind_a_link",
        "files/test_files.py::test_a_set_is_written_neither_through_links_out_nor_into_pipes",
    ),
    "other programs' files, and those that git ignores": (
        "rulebook/test_source_walk.py::test_environments_hidden_folders_and_what_git_ignores_are_left_alone",
        "rulebook/test_source_walk.py::test_other_programs_files_are_left_alone",
        "rulebook/test_source_walk.py::test_what_is_misspelt_or_begun_is_not",
        "rulebook/test_source_walk.py::test_nothing_left_is_not_answered",
    ),
    "lists of what git ignores that never end, or are elsewhere": (
        MEASURED,
        "rulebook/test_git_ignores.py::test_a_hostile_pattern_takes_few_steps",
        "rulebook/test_git_ignores.py::test_a_linked_list_of_patterns_and_a_pipe_are_not_read",
        "settings/test_search_path.py::test_a_pipe_is_no_file_of_settings",
    ),
    "names that drive a terminal or a runner": (
        "cli/test_hostile_names.py::test_no_line_of_any_output_drives_anything",
        "cli/test_verify.py::test_names_cannot_drive_the_terminal",
        "automata/test_compiled_file.py::test_names_that_a_terminal_would_obey_are_refused",
    ),
    "cells that a spreadsheet runs": (
        "cli/test_hostile_names.py::test_csv_has_no_formula",
        "cli/test_hostile_names.py::test_a_cell_that_a_spreadsheet_would_run_is_a_text",
    ),
    "comments and names that look otherwise than they are": (
        "programs/bad/hidden_in_comments.rules",
        "programs/bad/lookalikes.rules",
    ),
    "a planted cache": (
        "rulebook/test_recollection.py::test_what_others_may_write_to_is_not_trusted",
        "rulebook/test_recollection.py::test_what_somebody_else_has_written_is_not_trusted",
        "automata/test_compiled_cache.py::test_what_others_may_write_to_is_not_trusted",
        "automata/test_compiled_cache.py::test_what_somebody_else_has_written_is_not_trusted",
    ),
    "the process that runs Spot": (
        "automata/test_confinement.py::test_a_confined_process_writes_nothing_and_talks_to_nobody",
        "automata/test_confinement.py::test_where_it_cannot_be_confined_it_is_refused_if_so_asked_for",
    ),
    # Supply chain
    "packages that the lock does not name": (
        "launcher/test_set_up.py::test_the_lock_of_the_python_is_installed",
        "launcher/test_failure.py::test_what_the_lock_refuses_is_shown_with_the_way_out",
        "house/test_release.py::test_the_bill_of_materials_has_every_locked_release",
    ),
    # Always
    "every verb on hostile inputs": (
        "fuzz/test_targets.py::test_it_answers_or_refuses",
        "recordings/test_mutations.py::test_recordings_with_mistakes",
    ),
}


@pytest.mark.parametrize("attack", ANSWERED)
def test_it_has_a_test_that_runs_every_time(attack):
    assert ANSWERED[attack]
    for answer in ANSWERED[attack]:
        path, _, name = answer.partition("::")
        text = (TESTS / path).read_text(encoding="utf-8")
        if not name:
            assert (TESTS / path).with_suffix(".expected").is_file()
            continue
        decorated = re.search(rf"((?:^@.*\n(?:^[ )].*\n)*)*)^def {name}\(", text, re.MULTILINE)
        assert decorated, answer
        assert "@pytest.mark.long" not in decorated[1], answer
