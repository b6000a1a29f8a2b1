// SPDX-License-Identifier: GPL-3.0-or-later
//
// A Flamenco job type for batches of Thenar. Copy this file into the folder `scripts` beside Flamenco Manager and restart it.
// Needs Thenar installed in the Blender of every Worker, and the job file, its scenes and the results on shared storage.
// Each part solves every n-th case; the last task writes the tables and the contact sheet from what the parts left.

const JOB_TYPE = {
    label: "Thenar: contact of many cases",
    description: "Press hands against products, case by case, from a job file",
    settings: [
        { key: "jobs_file", type: "string", subtype: "file_path", required: true, visible: "submission",
          description: "Job file with [[case]] or [[sweep]] tables" },
        { key: "results_folder", type: "string", subtype: "dir_path", required: true, visible: "submission",
          description: "Folder for results; a run that was broken off goes on from there" },
        { key: "parts", type: "int32", default: 8, propargs: { min: 1, max: 10000 }, visible: "submission",
          description: "Tasks among which the cases are dealt out; about one to three for each Worker" },
        { key: "blendfile", type: "string", required: false, visible: "hidden",
          description: "Not used: the job file names the scenes" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const tables = batchTask("tables", settings, []);
    for (let part = 1; part <= settings.parts; part++) {
        const task = batchTask(`part-${part}`, settings, ["--part", `${part}/${settings.parts}`]);
        tables.addDependency(task);
        job.addTask(task);
    }
    job.addTask(tables);
}

function batchTask(name, settings, more) {
    const task = author.Task(name, "blender");
    task.addCommand(author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: [],
        blendfile: "",
        args: ["--command", "thenar", "batch", settings.jobs_file, "--out", settings.results_folder, ...more],
    }));
    return task;
}
