// SPDX-License-Identifier: GPL-3.0-or-later
/// Chooses how much a page of a part shows, so that it fits on one sheet of paper.

import type { Sheet } from "./data.ts";

/// The most that a page shows.
export interface Room {
    /// The size of the pictures: 0 is the largest.
    pictures: number;
    parts: number;
    labels: number;
    /// Doubts, warnings and reasons.
    notes: number;
    facts: number;
    /// Characters of a text.
    characters: number;
}

const [fewRows, fewestRows] = [8, 3];

/// From everything to what fits with the longest data. Every entry shows at most what the entry before shows.
export function roomsOf(sheet: Sheet): Room[] {
    const parts = sheet.inspection?.rows.length ?? 0;
    const labels = sheet.inspection?.labels.length ?? 0;
    const facts = sheet.facts.length + (sheet.inspection?.facts.length ?? 0);
    let room: Room = { pictures: 0, parts, labels, notes: sheet.doubts.length + sheet.warnings.length + sheet.reasons.length, facts, characters: 4000 };
    const rooms = [room];
    const then = (less: Partial<Room>) => rooms.push((room = { ...room, ...less }));
    const rowsDownTo = (last: number) => {
        for (let rows = Math.max(room.parts, room.labels) - 1; rows >= last; --rows) then({ parts: Math.min(room.parts, rows), labels: Math.min(room.labels, rows) });
    };
    then({ pictures: 1 });
    then({ pictures: 2 });
    rowsDownTo(fewRows);
    then({ characters: 400, notes: Math.min(room.notes, 8) });
    then({ facts: Math.min(room.facts, 16) });
    then({ characters: 240 });
    then({ pictures: 3 });
    rowsDownTo(fewestRows);
    then({ notes: Math.min(room.notes, 4), facts: Math.min(room.facts, 10) });
    then({ characters: 120, facts: Math.min(room.facts, 6) });
    then({ characters: 80, notes: Math.min(room.notes, 2), facts: Math.min(room.facts, 4) });
    return rooms;
}

/// The first entry that fits, or the last one. Neighbouring parts need about the same, so the search begins at `guess`.
export function firstFit(count: number, fits: (index: number) => boolean, guess: number): number {
    let [low, high] = [0, count - 1];
    const start = Math.min(guess, high);
    if (fits(start)) high = start;
    else low = Math.min(start + 1, high);
    if (high === start && start > 0 && !fits(start - 1)) return start;
    while (low < high) {
        const middle = Math.floor((low + high) / 2);
        if (fits(middle)) high = middle;
        else low = middle + 1;
    }
    return low;
}

/// A text with at most about this number of characters, and how many are left out.
export function shortened(text: string, characters: number): string {
    const all = [...text];
    return all.length <= characters + 30 ? text : `${all.slice(0, characters).join("").trimEnd()} … (${all.length - characters} more characters)`;
}
