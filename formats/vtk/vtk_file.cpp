// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCommand.h>

#include "scanmill/base/error.hpp"
#include "vtk/vtk_arrays.hpp"

namespace scanmill::vtk {

namespace {

/// Keeps what VTK would print of an error.
class KeptError : public vtkCommand {
public:
    static KeptError* New() { return new KeptError; }
    void Execute(vtkObject*, unsigned long, void* text) override {
        if (sentence.empty() && text) sentence = static_cast<const char*>(text);
    }
    std::string sentence;
};

}  // namespace

void write(vtkXMLWriter& writer, vtkPointSet& data, OutputBuffer& out) {
    const auto kept = vtkSmartPointer<KeptError>::New();
    writer.AddObserver(vtkCommand::ErrorEvent, kept);
    writer.SetInputData(&data);
    writer.SetDataModeToAppended();
    writer.EncodeAppendedDataOff();
    writer.SetCompressorTypeToNone();
    writer.SetHeaderTypeToUInt64();
    writer.SetByteOrderToLittleEndian();
    writer.WriteToOutputStringOn();
    if (writer.Write() == 0 || !kept->sentence.empty())
        throw Error("VTK could not write it: {}", kept->sentence.empty() ? "no reason was given" : kept->sentence)
            .hint("write PLY");
    out.text("<?xml version=\"1.0\"?>\n");
    out.text(writer.GetOutputString());
}

}  // namespace scanmill::vtk
